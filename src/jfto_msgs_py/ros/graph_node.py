"""What all nodes of the graph share: parameters, lifecycle, diagnostics."""

from __future__ import annotations

import time
from dataclasses import replace
from typing import Any, Generic, TypeVar

from diagnostic_msgs.msg import DiagnosticArray
from rcl_interfaces.msg import Log
from rclpy.clock import Clock, ROSClock
from rclpy.clock_type import ClockType
from rclpy.lifecycle import LifecycleNode, LifecyclePublisher, TransitionCallbackReturn

from jfto_msgs_py.errors import JftoError, ScenarioError
from jfto_msgs_py.records.event import ERROR, WARN, Event
from jfto_msgs_py.ros import qos, topics
from jfto_msgs_py.ros.clock import ClockReports
from jfto_msgs_py.ros.diagnostics import Status, encode_diagnostics
from jfto_msgs_py.ros.events import EventLimit, encode_event
from jfto_msgs_py.ros.intake import Intake
from jfto_msgs_py.ros.parameters import NodeParameters
from jfto_msgs_py.scenario import Scenario

Options = TypeVar("Options")
_DIAGNOSTICS_PERIOD_S = 1.0


class GraphNode(LifecycleNode, Generic[Options]):
    """A lifecycle node with the scenario's parameters and its own options.

    A subclass makes its publishers, subscriptions, services and timers in `build`; they go when
    the node is cleaned up, or when parameters have changed by the time it is activated.
    `answers_later` says that services of it answer when something has been done: by coroutines.
    """

    answers_later = False

    def __init__(self, name: str, options_type: type[Options], **arguments: Any) -> None:
        super().__init__(name, automatically_declare_parameters_from_overrides=True, **arguments)
        self.is_active = False
        self.error: JftoError | None = None
        self.intake = Intake(self.get_logger())
        self._built_from: tuple[Scenario, Options] | None = None
        self._entities: dict[str, set[Any]] = {}
        self._event_limit = EventLimit(time.monotonic)
        # Of the node, not of one configuration: what happened stays to be read.
        self._events = self.create_publisher(Log, topics.EVENTS, qos.events())
        self._parameters_of_node = NodeParameters(
            self, options_type, lambda: self.is_active, self.check
        )
        self._clock_reports = ClockReports(self)
        self.autostart = bool(self.get_parameter("autostart").value)

    def check(self, scenario: Scenario, options: Options) -> None:
        """Refuse parameters that do not fit one another by raising JftoError."""

    def build(self, scenario: Scenario, options: Options) -> None:
        """Make publishers, subscriptions, services and timers; may raise JftoError."""
        raise NotImplementedError

    def activated(self) -> None:
        """Begin to work; publishers are on."""

    def deactivated(self) -> None:
        """Stop to work; publishers are still on."""

    def released(self) -> None:
        """Forget what `build` made besides entities of ROS."""

    def statuses(self, now_ns: int) -> list[Status]:
        """Diagnostics: one status per UAV and one for the node."""
        raise NotImplementedError

    def now_ns(self) -> int:
        """Time on the node's clock, ns since the epoch; 0 until simulated time has come."""
        return int(self.get_clock().now().nanoseconds)

    def announce(self, event: Event) -> None:
        """Tell the operator, as an event and in the log, what happened and what was done.

        It goes out with this node's name and time. Of many of one kind and UAV in a short time only
        some are told, with the number of the others.
        """
        held = self._event_limit.admit(event.kind, event.uav_id)
        if held is None:
            return
        text = f"{event.text} ({held} more of this kind not told)" if held else event.text
        event = replace(event, text=text, stamp_ns=self.now_ns(), node=self.get_name())
        self._events.publish(encode_event(event))
        about = f"{event.kind}: {event.uav_id}" if event.uav_id else event.kind
        line = f"{about}: {event.text}"
        # Each of its own: a logger's filter belongs to the line.
        if event.level >= ERROR:
            self.get_logger().error(line)
        elif event.level >= WARN:
            self.get_logger().warning(line)
        else:
            self.get_logger().info(line)

    @property
    def time_is_simulated(self) -> bool:
        """Whether the node's clock follows /clock."""
        clock = self.get_clock()
        return isinstance(clock, ROSClock) and clock.ros_time_is_active

    def start(self) -> None:
        """Configure, and activate if the parameter `autostart` says so; raises JftoError."""
        if not self.autostart:
            return
        for trigger in (self.trigger_configure, self.trigger_activate):
            if trigger() != TransitionCallbackReturn.SUCCESS:
                raise self.error or JftoError(f"{self.get_name()}: could not be started.")

    def on_configure(self, state: Any) -> TransitionCallbackReturn:
        """Read the parameters and make everything; a JftoError leaves the node unconfigured."""
        if not self._guarded(self._rebuild):
            return TransitionCallbackReturn.FAILURE
        return super().on_configure(state)

    def on_activate(self, state: Any) -> TransitionCallbackReturn:
        """Work, with the parameters as they are now."""
        if not self._guarded(self._rebuild):
            return TransitionCallbackReturn.FAILURE
        result = super().on_activate(state)
        self.is_active = True
        if not self._guarded(self.activated):
            self.is_active = False
            super().on_deactivate(state)
            return TransitionCallbackReturn.FAILURE
        return result

    def on_deactivate(self, state: Any) -> TransitionCallbackReturn:
        """Be silent."""
        self.is_active = False
        self.deactivated()
        return super().on_deactivate(state)

    def on_cleanup(self, state: Any) -> TransitionCallbackReturn:
        """Forget everything but the parameters."""
        self._release()
        return super().on_cleanup(state)

    def on_shutdown(self, state: Any) -> TransitionCallbackReturn:
        """End for good."""
        self.is_active = False
        self._release()
        return super().on_shutdown(state)

    def destroy_node(self) -> None:
        """Take the node off the network."""
        self.is_active = False
        self.released()
        super().destroy_node()

    def _guarded(self, step: Any) -> bool:
        try:
            step()
        except JftoError as error:
            self.error = error
            problems = error.problems if isinstance(error, ScenarioError) else [str(error)]
            for problem in problems:
                # Each of its own: a logger's filter belongs to the line.
                self.get_logger().error(problem)
            return False
        return True

    def _rebuild(self) -> None:
        wanted = self._parameters_of_node.read()
        if wanted == self._built_from:
            return
        self._release()
        before = self._listed()
        self.build(*wanted)
        self._diagnostics = self.create_publisher(
            DiagnosticArray, topics.DIAGNOSTICS, qos.default()
        )
        # They are for people, who live by the wall clock however fast simulated time passes.
        wall = Clock(clock_type=ClockType.STEADY_TIME)
        self.create_timer(_DIAGNOSTICS_PERIOD_S, self._diagnose, clock=wall)
        self._entities = {kind: new - before[kind] for kind, new in self._listed().items()}
        self._built_from = wanted

    def _listed(self) -> dict[str, set[Any]]:
        return {
            "publisher": set(self.publishers),
            "subscription": set(self.subscriptions),
            "service": set(self.services),
            "timer": set(self.timers),
            "guard_condition": set(self.guards),
        }

    def _release(self) -> None:
        self.released()
        entities, self._entities = self._entities, {}
        self._built_from = None
        for kind, made in entities.items():
            for entity in made:
                if isinstance(entity, LifecyclePublisher):
                    self.destroy_lifecycle_publisher(entity)
                else:
                    getattr(self, f"destroy_{kind}")(entity)

    def _diagnose(self) -> None:
        if self._built_from is None:
            return
        now_ns = self.now_ns()
        self._diagnostics.publish(
            encode_diagnostics(self.get_name(), now_ns, self.statuses(now_ns))
        )
