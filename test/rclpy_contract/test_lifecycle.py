"""Lifecycle nodes: transitions, results, services, publishers."""

import pytest
import rclpy
from lifecycle_msgs.msg import Transition, TransitionEvent
from lifecycle_msgs.srv import ChangeState
from rclpy.executors import SingleThreadedExecutor
from rclpy.lifecycle import LifecycleNode, TransitionCallbackReturn
from rclpy.node import Node
from std_msgs.msg import String

from rclpy_contract.environment import names, spin_until
from rclpy_contract.observations import RECORDED, agrees, attempt


class _Logging(LifecycleNode):
    """Logs its callbacks; configuring makes a publisher ``p``."""

    def __init__(self, name, **options):
        super().__init__(name, **options)
        self.log = []

    def _note(self, name, state, *more):
        self.log.append((name, state.label, *more))

    def on_configure(self, state):
        self._note("on_configure", state, state.state_id)
        self.p = self.create_lifecycle_publisher(String, "p", 10)
        return TransitionCallbackReturn.SUCCESS

    def on_activate(self, state):
        self._note("on_activate", state)
        return super().on_activate(state)

    def on_deactivate(self, state):
        self._note("on_deactivate", state)
        return super().on_deactivate(state)

    def on_cleanup(self, state):
        self._note("on_cleanup", state)
        return TransitionCallbackReturn.SUCCESS

    def on_shutdown(self, state):
        self._note("on_shutdown", state)
        return TransitionCallbackReturn.SUCCESS


def _state(node):
    current = node._state_machine.current_state
    return tuple(current)


def test_lifecycle():
    """The recorded life of a node, its log and its transition events."""
    rclpy.init(args=[])
    node, other = _Logging("lc", namespace="/uav1"), Node("m")
    events = []

    def note(event):
        shown = (event.transition.id, event.transition.label)
        events.append((*shown, event.start_state.label, event.goal_state.label, event.timestamp))

    other.create_subscription(TransitionEvent, "/uav1/lc/transition_event", note, 50)
    executor = SingleThreadedExecutor()
    executor.add_node(other)
    assert spin_until(executor, lambda: other.count_publishers("/uav1/lc/transition_event"))
    import rclpy.lifecycle as lifecycle

    environment = names() | {
        "LC": lifecycle,
        "TransitionCallbackReturn": TransitionCallbackReturn,
        "log": node.log,
        "m": other,
        "n": node,
        "st": _state,
    }
    for line in RECORDED["lifecycle"][:22]:
        came = attempt(line["did"], environment)
        assert agrees(line["saw"], came), f"{line}\n{came}"
    assert spin_until(executor, lambda: len(events) == 10)
    assert repr(events) == RECORDED["lifecycle"][22]["saw"]


def test_lifecycle_results():
    """What results of on_configure and on_error lead to."""
    rclpy.init(args=[])

    def tr(result, recovery=TransitionCallbackReturn.SUCCESS):
        class Configured(LifecycleNode):
            def on_configure(self, _state):
                if result == "raise":
                    raise RuntimeError("configuring failed")
                return result

            def on_error(self, state):
                log.append(("on_error", state.label, state.state_id))
                return recovery

        log = []
        node = Configured("r")
        try:
            return node.trigger_configure(), _state(node), log
        finally:
            node.destroy_node()

    environment = {"tr": tr, "TransitionCallbackReturn": TransitionCallbackReturn}
    for line in RECORDED["lifecycle_errors"]:
        came = attempt(line["did"].split("   (")[0], environment)
        assert agrees(line["saw"], came), f"{line}\n{came}"


def test_lifecycle_services():
    """The five services, and what an illegal request does to the node."""
    rclpy.init(args=[])
    node, other = LifecycleNode("ls"), Node("client")
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    executor.add_node(other)

    def call(kind, name, request=None):
        client = other.create_client(kind, f"/ls/{name}")
        assert spin_until(executor, client.service_is_ready)
        future = client.call_async(request or kind.Request())
        try:
            assert spin_until(executor, future.done)
        finally:
            other.destroy_client(client)
        return future.result()

    def cs(number, label=""):
        request = ChangeState.Request(transition=Transition(id=number, label=label))
        return call(ChangeState, "change_state", request).success, _state(node)[1]

    import lifecycle_msgs.srv

    environment = names() | {"call": call, "cs": cs, "n": node, "LifecycleNode": LifecycleNode}
    for kind in ("ChangeState", "GetAvailableStates", "GetAvailableTransitions", "GetState"):
        environment[kind] = getattr(lifecycle_msgs.srv, kind)
    for line in RECORDED["lifecycle_services"][:18]:
        came = attempt(line["did"], environment)
        assert agrees(line["saw"], came), f"{line}\n{came}"


def test_plain_timer_of_lifecycle_node():
    """Plain timers run in every state."""
    rclpy.init(args=[])
    node, ticks = LifecycleNode("lt"), []
    node.create_timer(0.02, lambda: ticks.append("tick"))
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    assert spin_until(executor, lambda: len(ticks) >= 2)


def test_lifecycle_publisher_is_silent_unless_active():
    """Messages published while inactive are dropped."""
    rclpy.init(args=[])
    node, other, got = _Logging("lp"), Node("listener"), []
    node.trigger_configure()
    other.create_subscription(String, "p", lambda message: got.append(message.data), 10)
    executor = SingleThreadedExecutor()
    executor.add_node(other)
    assert spin_until(executor, lambda: node.p.get_subscription_count() == 1)
    node.p.publish(String(data="lost"))
    node.trigger_activate()
    node.p.publish(String(data="sent"))
    assert spin_until(executor, lambda: got)
    assert got == ["sent"]


def test_managed_entities_decide():
    """A managed entity that fails keeps the node where it is."""
    rclpy.init(args=[])
    from rclpy.lifecycle import ManagedEntity

    class Refusing(ManagedEntity):
        def on_configure(self, _state):
            return TransitionCallbackReturn.FAILURE

    node = LifecycleNode("me")
    node.add_managed_entity(Refusing())
    assert node.trigger_configure() == TransitionCallbackReturn.FAILURE
    assert _state(node) == (1, "unconfigured")
    with pytest.raises(TypeError):
        node.create_lifecycle_publisher(String, "q", 10, publisher_class=object)
