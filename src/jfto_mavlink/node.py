"""The bridge in the graph: vehicles' poses, fixes, batteries and health, and orders to them."""

from __future__ import annotations

import math
import threading
from collections import deque
from collections.abc import Callable
from contextlib import ExitStack
from functools import partial
from typing import Any

from diagnostic_msgs.msg import DiagnosticStatus
from geometry_msgs.msg import PoseStamped
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.task import Future
from sensor_msgs.msg import BatteryState, NavSatFix
from std_msgs.msg import Header
from std_srvs.srv import Trigger
from trajectory_msgs.msg import MultiDOFJointTrajectory

from jfto_mavlink.errors import MavlinkError, MissionError
from jfto_mavlink.fleet.orders import FleetOrders
from jfto_mavlink.fleet.watched_flight import Recognised
from jfto_mavlink.flight.telemetry import (
    BatterySample,
    FixSample,
    LinkState,
    Measurement,
    PositionSample,
)
from jfto_mavlink.mission.limits import Ground
from jfto_mavlink.mission_state import MissionState, encode_mission_state
from jfto_mavlink.operation import Incoming, NodeSide, Operation, open_operation, real_roster
from jfto_mavlink.options import BridgeOptions
from jfto_mavlink.order_server import OrderServer
from jfto_mavlink.order_services import OrderServices, OrderState
from jfto_mavlink.protocol.exchange import Report
from jfto_mavlink.ros_messages import (
    Expected,
    encode_battery,
    encode_fix,
    node_status,
    uav_status,
)
from jfto_msgs_py.errors import InputError
from jfto_msgs_py.order_socket import order_socket
from jfto_msgs_py.records.event import ERROR, INFO, Event
from jfto_msgs_py.ros import qos, topics
from jfto_msgs_py.ros.clock import TickedClock
from jfto_msgs_py.ros.diagnostics import Status
from jfto_msgs_py.ros.graph_node import GraphNode
from jfto_msgs_py.ros.lift_off import encode_lift_off
from jfto_msgs_py.ros.opening import Opening
from jfto_msgs_py.ros.vehicle import decode_trajectory, encode_pose
from jfto_msgs_py.scenario import Scenario

INCOMING_KEPT = 5000


class MavlinkBridgeNode(GraphNode[BridgeOptions]):
    """Speaks with the vehicles of a plan; what is slow happens in threads of its own.

    `ground_of` knows a scenario's terrain.
    """

    answers_later = True

    def __init__(
        self, ground_of: Callable[[Scenario], Ground] | None = None, **arguments: Any
    ) -> None:
        self._ground_of = ground_of
        self._opening: Opening[Operation] | None = None
        self._incoming: deque[Incoming | Operation | OrderState] = deque(maxlen=INCOMING_KEPT)
        self._orders = OrderServices(self._fleet_orders, self._take)
        self._waiting: list[Future] = []
        self._server: OrderServer | None = None
        self._state = MissionState()
        self._trajectories: dict[str, Any] = {}
        self._trouble: dict[str, str] = {}
        # Threads of ours wake the executor only while there is what they wake.
        self._waking = threading.Lock()
        self._alarm: Any = None
        self._time: TickedClock | None = None
        super().__init__("mavlink_bridge", BridgeOptions, **arguments)

    def check(self, scenario: Scenario, options: BridgeOptions) -> None:
        """Refuse rosters that are not the fleet's, and what cannot be flown."""
        if not options.plan_file:
            raise InputError("plan_file is empty. Name the plan that the vehicles fly.")
        real_roster(options, scenario.fleet.ids)
        if options.speedup != 1.0 and not options.vehicle_stamps:
            raise InputError(
                f"speedup is {options.speedup}; real vehicles keep time. Set vehicle_stamps "
                "where others simulate them."
            )

    def build(self, scenario: Scenario, options: BridgeOptions) -> None:
        """Publishers per UAV, services, and the way in for what other threads bring."""
        self._scenario, self._options = scenario, options
        ids = scenario.fleet.ids

        def per_uav(kind: Any, name: Callable[[str], str]) -> dict[str, Any]:
            return {u: self.create_lifecycle_publisher(kind, name(u), qos.sensor()) for u in ids}

        self._poses = per_uav(PoseStamped, topics.pose)
        self._fixes = per_uav(NavSatFix, topics.fix)
        self._batteries = per_uav(BatteryState, topics.battery)
        self._lift_off = self.create_lifecycle_publisher(Header, topics.LIFT_OFF, qos.latched())
        for uav in ids:
            self.create_subscription(
                MultiDOFJointTrajectory,
                topics.trajectory(uav),
                partial(self._on_trajectory, uav),
                qos.latched(),
            )
        self._states = self.create_lifecycle_publisher(
            DiagnosticStatus, topics.MISSION_STATE, qos.latched()
        )
        group = ReentrantCallbackGroup()
        for name in topics.MISSION_SERVICES:
            verb = name.rpartition("/")[2]
            self.create_service(Trigger, name, partial(self._on_order, verb), callback_group=group)
        self._alarm = self.create_guard_condition(self._on_alarm)
        self._time = TickedClock(self.get_clock(), options.speedup)

    def activated(self) -> None:
        """Open the links if they are not."""
        if self._operation is not None:
            self._operation.flight.begin()
        self._publish_state()
        if self._server is None:
            self._server = self._serve()
        if self._opening is None:
            self._opening = Opening(self._open, self._take, self._say)

    def deactivated(self) -> None:
        """Publish nothing, and stop what is streamed to; links stay, for vehicles miss stations."""
        operation = self._operation
        if operation is not None:
            threading.Thread(target=self._end, args=(operation.orders,), daemon=True).start()

    def released(self) -> None:
        """Stop what is streamed to and close the links."""
        server, self._server = self._server, None
        if server is not None:
            server.close()
        opening, self._opening = self._opening, None
        if opening is not None:
            if opening.opened is not None:
                self._end(opening.opened.orders)
            opening.close()
        if self._time is not None:
            self._time.close()
            self._time = None
        with self._waking:
            self._alarm = None
        for answer in self._waiting:
            answer.set_result((False, "The bridge was cleaned up."))
        for kept in (self._waiting, self._orders.answers, self._incoming, self._trouble):
            kept.clear()

    @property
    def _operation(self) -> Operation | None:
        return None if self._opening is None else self._opening.opened

    def _open(self, stack: ExitStack) -> Operation:
        """Plan, missions and links; runs in the opening's thread."""
        scenario, options, ground_of = self._scenario, self._options, self._ground_of
        assert self._time is not None
        side = NodeSide(
            self._time.now_ns,
            self._time if options.vehicle_stamps else None,
            self._take,
            self._report,
            self._tell,
            lambda tag, begun_ns: self._lift_off.publish(encode_lift_off(begun_ns, tag)),
        )
        ground = None
        if options.check_terrain and ground_of is not None:
            ground = partial(ground_of, scenario)
        return open_operation(stack, scenario, options, ground, side)

    def _serve(self) -> OrderServer | None:
        """Orders from this computer without ROS, where nobody else takes them."""
        try:
            path = order_socket(self.context.get_domain_id())
            return OrderServer(path, self._orders.obey)
        except InputError as error:
            self.get_logger().warning(f"jfto mission order will not find this bridge: {error}")
            return None

    def _fleet_orders(self) -> FleetOrders | str:
        """The fleet's orders, or why there are none; called in threads."""
        if not self.is_active:
            return "The bridge is not active. Activate it first."
        operation = self._operation
        if operation is None:
            note = "" if self._opening is None else self._opening.note
            return f"The vehicles are not linked yet: {note}"
        return operation.orders

    def _take(self, one: Incoming | Operation | OrderState) -> None:
        """Hand something to the executor; called in other threads."""
        self._incoming.append(one)
        self._wake()

    def _wake(self) -> None:
        with self._waking:
            if self._alarm is not None:
                self._alarm.trigger()

    def _say(self, note: str) -> None:
        self.get_logger().warning(f"Not linked: {note}")

    def _report(self, uav: str, step: Report) -> None:
        if not step.total:
            # Steps that can be counted are too many for a log.
            self.get_logger().info(f"{uav}: {step.text}")

    def _tell(self, event: Event) -> None:
        """Announce what an operator must learn of; changes of plain state are for the log."""
        if event.level < INFO:
            # Whoever arms a vehicle has said so already.
            if event.text != "armed":
                self.get_logger().info(f"{event.uav_id}: {event.text}")
        else:
            self.announce(event)
        if event.level >= ERROR:
            self._change_state(self._state.alarmed(event.text))

    def _change_state(self, state: MissionState) -> None:
        if state != self._state:
            self._state = state
            self._publish_state()

    def _publish_state(self) -> None:
        self._states.publish(encode_mission_state(self._state))

    def _on_alarm(self) -> None:
        """Publish what came in, and answer services that are done."""
        while self._orders.answers:
            answer, success, text = self._orders.answers.popleft()
            if answer in self._waiting:
                self._waiting.remove(answer)
                answer.set_result((success, text))
        while self._incoming:
            one, operation = self._incoming.popleft(), self._operation
            if isinstance(one, Event):
                self._tell(one)
            elif isinstance(one, OrderState):
                self._change_state(self._state.ordered(one))
                if one.event is not None:
                    self.announce(one.event)
            elif operation is None:
                # It is of links that are closed already.
                continue
            elif isinstance(one, Operation):
                one.begin()
                for uav in list(self._trajectories):
                    self._pass_on(uav)
            elif isinstance(one, LinkState | Recognised):
                operation.take(one)
                self._change_state(self._state.in_phase(operation.phase))
            elif self.is_active:
                self._publish(operation, one)

    def _publish(self, operation: Operation, sample: Measurement) -> None:
        stamp_ns = operation.stamp_ns(sample)
        if stamp_ns is None or stamp_ns < 0:
            # Simulated time has not begun.
            return
        if isinstance(sample, PositionSample):
            pose = operation.pose(sample, stamp_ns)
            self._poses[sample.uav].publish(encode_pose(pose))
        elif isinstance(sample, FixSample):
            self._fixes[sample.uav].publish(encode_fix(sample, stamp_ns))
        elif isinstance(sample, BatterySample):
            self._batteries[sample.uav].publish(encode_battery(sample, stamp_ns))

    def _on_trajectory(self, uav: str, message: Any) -> None:
        trajectory = self.intake.take(topics.trajectory(uav), decode_trajectory, message)
        if trajectory is not None:
            self._trajectories[uav] = trajectory
            self._pass_on(uav)

    def _pass_on(self, uav: str) -> None:
        if self._operation is None:
            return
        self._trouble.pop(uav, None)
        try:
            self._operation.orders.take(uav, self._trajectories[uav])
        except MissionError as error:
            self._trouble[uav] = str(error)
            self.get_logger().error(str(error))

    async def _on_order(self, verb: str, request: Any, response: Any) -> Any:
        """Carry out an order in a thread; answers with what was done, or the numbered error."""
        del request
        answer: Future = Future()
        self._waiting.append(answer)
        self._orders.begin(verb, answer)
        response.success, response.message = await answer
        return response

    def _end(self, orders: FleetOrders) -> None:
        try:
            orders.close()
        except MavlinkError as error:
            self.get_logger().error(str(error))

    def statuses(self, now_ns: int) -> list[Status]:
        """The link as a whole, and each vehicle."""
        del now_ns
        operation = self._operation
        note = "not active" if self._opening is None else self._opening.note
        guided = operation is not None and operation.orders.guided
        node = node_status(note, guided, self.intake.facts("/"))
        if operation is None:
            return [node, *(Status(uav, node.level, note) for uav in self._scenario.fleet.ids)]
        found = [node]
        for uav in self._scenario.fleet.ids:
            identity = operation.link.station.tracks[uav].identity
            conflict = identity.trouble(operation.link.clock())
            expected = Expected(
                # Vehicles that stamp what they report need not be compared with anybody's clock.
                math.inf if self._options.vehicle_stamps else operation.plan.slots.duration_s / 4,
                conflict or self._trouble.get(uav, ""),
                operation.orders.streaming(uav),
            )
            state = operation.states.get(uav)
            found.append(uav_status(uav, state, operation.link.clock(), expected))
        return found
