"""The conductor's own node: it listens to the graph, gives orders and says what happened."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from typing import Any

import rclpy
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import PoseStamped
from rcl_interfaces.msg import Log
from rclpy.executors import SingleThreadedExecutor
from rclpy.parameter import Parameter
from rclpy.serialization import deserialize_message
from rclpy.signals import SignalHandlerOptions
from sensor_msgs.msg import BatteryState
from std_msgs.msg import Float64, Header, UInt8MultiArray
from std_srvs.srv import Trigger

from jfto.flight.fleet_status import FleetStatus, GraphStatus
from jfto.flight.screen.tracker import FlightTracker
from jfto_msgs_py.errors import InputError, MessageError
from jfto_msgs_py.plan_file import plan_tag
from jfto_msgs_py.records.event import Event
from jfto_msgs_py.records.plan import Plan
from jfto_msgs_py.ros import qos, topics
from jfto_msgs_py.ros.diagnostics import decode_diagnostics
from jfto_msgs_py.ros.events import decode_event, encode_event
from jfto_msgs_py.ros.lift_off import lift_off_of
from jfto_msgs_py.ros.network import decode_adjacency
from jfto_msgs_py.ros.vehicle import decode_pose

NODE_NAME = "conductor"
# How long the network is listened to for graphs that run already.
_LISTEN_S = 1.0
# An operator's key is looked for so often while nothing else comes.
_GLANCE_S = 0.05


class Client:
    """Subscriptions that feed a `GraphStatus` and a `FlightTracker`, and the mission services.

    `answered` is called from `spin` with verb, success and text of each order's answer.
    """

    def __init__(
        self,
        node: Any,
        executor: Any,
        plan: Plan,
        tracker: FlightTracker,
        answered: Callable[[str, bool, str], None],
    ) -> None:
        self.graph = GraphStatus(tuple(uav.id for uav in plan.uavs))
        self._node, self._executor, self._tracker = node, executor, tracker
        self._answered, self._plan_tag = answered, plan_tag(plan)
        # Whether the bridge has told how the flights of all ended.
        self.fleet_ended = False
        # Made before they are needed: who is found first must not be looked for in an emergency.
        self._services = {
            name.rpartition("/")[2]: node.create_client(Trigger, name)
            for name in topics.MISSION_SERVICES
        }
        self._orders: dict[str, Any] = {}
        # Poses come by the hundred: only the last of each is decoded, when somebody looks.
        self._poses: dict[str, bytes] = {}
        self._subscribe(plan)
        self._events = node.create_publisher(Log, topics.EVENTS, qos.events())

    def _subscribe(self, plan: Plan) -> None:
        node = self._node
        subscribe = node.create_subscription
        subscribe(DiagnosticArray, topics.DIAGNOSTICS, self._on_diagnostics, qos.default())
        subscribe(Log, topics.EVENTS, self._on_event, qos.events())
        subscribe(Header, topics.LIFT_OFF, self._on_lift_off, qos.latched())
        subscribe(UInt8MultiArray, topics.ADJACENCY, self._on_adjacency, qos.latched())
        for uav in (each.id for each in plan.uavs):
            on_pose = partial(self._poses.__setitem__, uav)
            subscribe(PoseStamped, topics.pose(uav), on_pose, qos.sensor(), raw=True)
            on_battery = partial(self._on_battery, uav)
            subscribe(BatteryState, topics.battery(uav), on_battery, qos.sensor())
            on_power = partial(self._on_power, uav)
            subscribe(Float64, topics.tx_power(uav), on_power, qos.latched())

    @property
    def now_ns(self) -> int:
        """The vehicles' time, ns since the epoch; 0 until simulated time has come."""
        return int(self._node.get_clock().now().nanoseconds)

    def spin(self, duration_s: float, urgent: Callable[[], bool] = lambda: False) -> None:
        """Take in what comes within a while, less where something is urgent."""
        end_s = time.monotonic() + duration_s
        while (left_s := end_s - time.monotonic()) > 0 and not urgent():
            self._executor.spin_once(timeout_sec=min(left_s, _GLANCE_S))
        self._exchange()

    def fleet(self) -> FleetStatus:
        """The fleet by the last diagnostics."""
        return self.graph.fleet(time.monotonic(), self.now_ns / 1e9)

    def order(self, verb: str) -> None:
        """Call a mission service once it is there; its answer comes through `answered`."""
        self._drop(verb)
        self._orders[verb] = (self._services[verb], None)
        self._exchange()

    def _exchange(self) -> None:
        """Send what can be sent by now, and pass on the answers that have come."""
        for verb, (client, future) in list(self._orders.items()):
            if future is None:
                if client.service_is_ready():
                    self._orders[verb] = (client, client.call_async(Trigger.Request()))
            elif future.done():
                response = future.result()
                self._drop(verb)
                self._answered(verb, bool(response.success), str(response.message))

    def drop_orders(self) -> None:
        """Wait for no answer any more: who should have given it is gone."""
        for verb in list(self._orders):
            self._drop(verb)

    def _drop(self, verb: str) -> None:
        _, future = self._orders.pop(verb, (None, None))
        if future is not None:
            future.cancel()

    def publish_event(self, level: int, kind: str, text: str) -> None:
        """Tell everybody, the recorder too, what happened and what was done."""
        event = Event(level, kind, "", " ".join(text.split()), self.now_ns, NODE_NAME)
        self._events.publish(encode_event(event))

    def take_progress(self) -> None:
        """Hand the last pose of each UAV, and how far its autopilot has come, to the tracker."""
        for uav, vehicle in self.fleet().uavs.items():
            self._tracker.take_linked(uav, linked=vehicle.linked)
            self._tracker.take_reached(uav, vehicle.reached, vehicle.late_s)
        poses = dict(self._poses)
        self._poses.clear()
        for uav, data in poses.items():
            self._on_pose(uav, deserialize_message(bytes(data), PoseStamped))

    def _on_pose(self, uav: str, message: Any) -> None:
        self._kept(lambda: self._tracker.take_pose(uav, decode_pose(message)))

    def _on_diagnostics(self, message: Any) -> None:
        self._kept(lambda: self.graph.take(decode_diagnostics(message)))

    def _on_event(self, message: Any) -> None:
        def take() -> None:
            event = decode_event(message)
            self.fleet_ended |= event.kind == "landed" and not event.uav_id
            self._tracker.take_event(event)

        self._kept(take)

    def _on_lift_off(self, message: Any) -> None:
        self._kept(lambda: self._tracker.take_lift_off(lift_off_of(message, self._plan_tag)))

    def _on_adjacency(self, message: Any) -> None:
        self._kept(lambda: self._tracker.take_adjacency(decode_adjacency(message)))

    def _on_battery(self, uav: str, message: Any) -> None:
        self._tracker.take_battery(uav, float(message.percentage))

    def _on_power(self, uav: str, message: Any) -> None:
        self._tracker.take_power(uav, float(message.data), self.now_ns)

    def _kept(self, take: Callable[[], None]) -> None:
        try:
            take()
        except MessageError as error:
            self._node.get_logger().warning(str(error), throttle_duration_sec=5.0)


@contextmanager
def open_client(
    plan: Plan,
    tracker: FlightTracker,
    answered: Callable[[str, bool, str], None],
    *,
    use_sim_time: bool,
    patience_s: float = 0.0,
) -> Iterator[Client]:
    """Join the graph for as long as the context lasts.

    Raises InputError where a graph of another program runs on the same ROS domain already, and
    does not end within `patience_s`: two would give orders to the same vehicles.
    """
    rclpy.init(args=[], signal_handler_options=SignalHandlerOptions.NO)
    try:
        overrides = [Parameter("use_sim_time", value=use_sim_time)]
        node = rclpy.create_node(NODE_NAME, parameter_overrides=overrides)
        executor = SingleThreadedExecutor()
        executor.add_node(node)
        try:
            _require_a_quiet_domain(node, executor, patience_s)
            yield Client(node, executor, plan, tracker, answered)
        finally:
            executor.shutdown()
            node.destroy_node()
    finally:
        rclpy.try_shutdown()


def _require_a_quiet_domain(node: Any, executor: Any, patience_s: float) -> None:
    begun_s = time.monotonic()
    quiet_s = begun_s + _LISTEN_S
    while time.monotonic() < quiet_s:
        executor.spin_once(timeout_sec=0.1)
        names = node.get_node_names()
        if names.count(NODE_NAME) <= 1 and "mavlink_bridge" not in names:
            continue
        quiet_s = time.monotonic() + _LISTEN_S
        if quiet_s > begun_s + _LISTEN_S + patience_s:
            raise InputError(
                "another flight runs on this ROS domain. End it, or set ROS_DOMAIN_ID to another "
                "number for this one. Nothing was started."
            )
