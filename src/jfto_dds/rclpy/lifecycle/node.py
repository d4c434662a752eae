"""Nodes with a lifecycle: unconfigured, inactive, active, finalized."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any, NamedTuple

from lifecycle_msgs import msg as lifecycle_msg
from lifecycle_msgs import srv as lifecycle_srv

from jfto_dds.wire import names
from jfto_dds.wire.qos_settings import QosSettings

from .._rclpy_pybind11 import RCLError
from .._rclpy_pybind11 import TransitionCallbackReturnType as TransitionCallbackReturn
from ..node import Node
from ._state_machine import STATES, TRANSITIONS, State, StateMachine, Transition
from .managed_entity import ManagedEntity
from .publisher import LifecyclePublisher


class LifecycleState(NamedTuple):
    """A state as callbacks see it."""

    label: str
    state_id: int


_CALLBACK_OF = {
    "configuring": "on_configure",
    "cleaningup": "on_cleanup",
    "shuttingdown": "on_shutdown",
    "activating": "on_activate",
    "deactivating": "on_deactivate",
    "errorprocessing": "on_error",
}


class LifecycleNodeMixin(ManagedEntity):
    """What makes a node a lifecycle node; needs the attributes of :class:`Node`."""

    create_service: Callable[..., Any]
    create_publisher: Callable[..., Any]
    destroy_publisher: Callable[..., bool]
    get_fully_qualified_name: Callable[[], str]
    _participant: Any
    _entry: Any
    context: Any

    def __init__(
        self, *, enable_communication_interface: bool = True, callback_group: Any = None
    ) -> None:
        # Bound now, as in rclpy: methods replaced later are not called.
        self._transition_callbacks = {
            busy: getattr(self, name) for busy, name in _CALLBACK_OF.items()
        }
        # In order of creation, so that runs repeat exactly; rclpy's set has no order.
        self._managed_entities: dict[ManagedEntity, None] = {}
        self._transition_writer: Any = None
        self._state_machine = StateMachine(self._publish_transition)
        if enable_communication_interface:
            self._open_interface(callback_group)

    def _open_interface(self, callback_group: Any) -> None:
        full_name = self.get_fully_qualified_name()
        support = lifecycle_msg.TransitionEvent._TYPE_SUPPORT
        self._transition_writer = self._participant.create_writer(
            self._entry,
            names.topic_name(f"{full_name}/transition_event"),
            support.full_name,
            QosSettings(),
        )
        for srv_type, name, callback in (
            (lifecycle_srv.ChangeState, "change_state", self._on_change_state),
            (lifecycle_srv.GetState, "get_state", self._on_get_state),
            (lifecycle_srv.GetAvailableStates, "get_available_states", self._on_states),
            (
                lifecycle_srv.GetAvailableTransitions,
                "get_available_transitions",
                self._on_transitions,
            ),
            (lifecycle_srv.GetAvailableTransitions, "get_transition_graph", self._on_graph),
        ):
            self.create_service(
                srv_type, f"{full_name}/{name}", callback, callback_group=callback_group
            )

    def _publish_transition(self, transition: Transition) -> None:
        writer = self._transition_writer
        if writer is None or writer.is_closed or not self.context.ok():
            return
        # Neither transition nor time stamp: what rcl_lifecycle sends too.
        event = lifecycle_msg.TransitionEvent(
            start_state=_state_message(transition.start),
            goal_state=_state_message(transition.goal),
        )
        writer.write(type(event)._TYPE_SUPPORT.serialize(event))

    def destroy_node(self) -> None:
        """Take the node off the network."""
        writer, self._transition_writer = self._transition_writer, None
        if writer is not None:
            self._participant.remove_endpoint(self._entry, writer)
        super().destroy_node()  # type: ignore[misc]

    def trigger_configure(self) -> TransitionCallbackReturn:
        """Go from unconfigured to inactive."""
        return self._change_state(lifecycle_msg.Transition.TRANSITION_CONFIGURE)

    def trigger_cleanup(self) -> TransitionCallbackReturn:
        """Go from inactive to unconfigured."""
        return self._change_state(lifecycle_msg.Transition.TRANSITION_CLEANUP)

    def trigger_activate(self) -> TransitionCallbackReturn:
        """Go from inactive to active."""
        return self._change_state(lifecycle_msg.Transition.TRANSITION_ACTIVATE)

    def trigger_deactivate(self) -> TransitionCallbackReturn:
        """Go from active to inactive."""
        return self._change_state(lifecycle_msg.Transition.TRANSITION_DEACTIVATE)

    def trigger_shutdown(self) -> TransitionCallbackReturn:
        """Go to finalized from any state in which nothing is going on."""
        number = self._state_machine.id_of("shutdown")
        if number is None:
            msg = "Shutdown transtion not possible"
            raise RCLError(msg)
        return self._change_state(number)

    def add_managed_entity(self, entity: ManagedEntity) -> None:
        """Let something follow this node's lifecycle."""
        if not isinstance(entity, ManagedEntity):
            msg = "Expected a rclpy.lifecycle.ManagedEntity instance."
            raise TypeError(msg)
        self._managed_entities[entity] = None

    def _ask_managed(self, callback_name: str, state: LifecycleState) -> TransitionCallbackReturn:
        for entity in tuple(self._managed_entities):
            result = getattr(entity, callback_name)(state)
            if not isinstance(result, TransitionCallbackReturn):
                msg = (
                    f"{callback_name}() return value of class {type(entity)} should be"
                    " `TransitionCallbackReturn`.\n"
                    f"Instance of the class that caused the failure: {entity}"
                )
                raise TypeError(msg)
            if result != TransitionCallbackReturn.SUCCESS:
                return result
        return TransitionCallbackReturn.SUCCESS

    def on_configure(self, state: LifecycleState) -> TransitionCallbackReturn:
        return self._ask_managed("on_configure", state)

    def on_cleanup(self, state: LifecycleState) -> TransitionCallbackReturn:
        return self._ask_managed("on_cleanup", state)

    def on_shutdown(self, state: LifecycleState) -> TransitionCallbackReturn:
        return self._ask_managed("on_shutdown", state)

    def on_activate(self, state: LifecycleState) -> TransitionCallbackReturn:
        return self._ask_managed("on_activate", state)

    def on_deactivate(self, state: LifecycleState) -> TransitionCallbackReturn:
        return self._ask_managed("on_deactivate", state)

    def on_error(self, state: LifecycleState) -> TransitionCallbackReturn:
        return self._ask_managed("on_error", state)

    def create_lifecycle_publisher(self, *args: Any, **kwargs: Any) -> LifecyclePublisher:
        """Create a publisher that is silent unless this node is active."""
        if "publisher_class" in kwargs:
            msg = "create_publisher() got an unexpected keyword argument 'publisher_class'"
            raise TypeError(msg)
        publisher = self.create_publisher(*args, **kwargs, publisher_class=LifecyclePublisher)
        self._managed_entities[publisher] = None
        return publisher

    def destroy_lifecycle_publisher(self, publisher: LifecyclePublisher) -> bool:
        """Destroy such a publisher; False where it is none of this node's."""
        self._managed_entities.pop(publisher, None)
        return self.destroy_publisher(publisher)

    def _run_callback(self, previous: LifecycleState) -> Any:
        callback = self._transition_callbacks.get(self._state_machine.current_state.label)
        if callback is None:
            return TransitionCallbackReturn.SUCCESS
        try:
            return callback(previous)
        except Exception as error:  # noqa: BLE001 - any failure leads to on_error, as in rclpy
            logger = self.get_logger()  # type: ignore[attr-defined]
            logger.error(f"Lifecycle callback raised {type(error).__name__}: {error}")
            return TransitionCallbackReturn.ERROR

    def _change_state(self, transition_id: int) -> TransitionCallbackReturn:
        before = self._state_machine.current_state
        previous = LifecycleState(state_id=before.id, label=before.label)
        self._state_machine.trigger_id(transition_id)
        result = self._run_callback(previous)
        self._state_machine.trigger_label(result.to_label())
        if result == TransitionCallbackReturn.ERROR:
            recovery = self._run_callback(previous)
            self._state_machine.trigger_label(recovery.to_label())
        return result

    def _on_change_state(self, request: Any, response: Any) -> Any:
        number: int | None = request.transition.id
        if request.transition.label:
            number = self._state_machine.id_of(request.transition.label)
            if number is None:
                response.success = False
                return response
        assert number is not None
        response.success = self._change_state(number) == TransitionCallbackReturn.SUCCESS
        return response

    def _on_get_state(self, _request: Any, response: Any) -> Any:
        response.current_state = _state_message(self._state_machine.current_state)
        return response

    def _on_states(self, _request: Any, response: Any) -> Any:
        response.available_states = [_state_message(state) for state in STATES.values()]
        return response

    def _on_transitions(self, _request: Any, response: Any) -> Any:
        response.available_transitions = _descriptions(self._state_machine.available())
        return response

    def _on_graph(self, _request: Any, response: Any) -> Any:
        response.available_transitions = _descriptions(TRANSITIONS)
        return response


def _state_message(state: State) -> Any:
    return lifecycle_msg.State(id=state.id, label=state.label)


def _descriptions(transitions: Iterable[Transition]) -> list[Any]:
    return [
        lifecycle_msg.TransitionDescription(
            transition=lifecycle_msg.Transition(id=item.id, label=item.label),
            start_state=_state_message(item.start),
            goal_state=_state_message(item.goal),
        )
        for item in transitions
    ]


class LifecycleNode(LifecycleNodeMixin, Node):
    """A node with a lifecycle."""

    def __init__(
        self, node_name: str, *, enable_communication_interface: bool = True, **kwargs: Any
    ) -> None:
        Node.__init__(self, node_name, **kwargs)
        LifecycleNodeMixin.__init__(
            self, enable_communication_interface=enable_communication_interface
        )
