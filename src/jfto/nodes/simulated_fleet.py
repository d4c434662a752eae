"""Simulated vehicles in the graph, with the air between them: they fly by MAVLink.

Their time is the graph's, and waits for it.
"""

from __future__ import annotations

import struct
import time
from collections.abc import Callable
from contextlib import ExitStack
from functools import partial
from pathlib import Path
from typing import Any

from geometry_msgs.msg import PoseStamped
from rclpy.clock import Clock
from rclpy.clock_type import ClockType
from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.time import Time
from rosgraph_msgs.msg import Clock as ClockMessage
from std_msgs.msg import Float64MultiArray, Header, UInt8MultiArray

from jfto.node_options import SimulatedFleetOptions
from jfto.simulation.fleet import UPTIME_S, FleetTime, fleet_air, vehicle_configs
from jfto.simulation.pace import FleetPace, PacedFlight, PaceSettings
from jfto_msgs_py.errors import InputError, PlanError
from jfto_msgs_py.plan_file import plan_tag, read_plan
from jfto_msgs_py.records.event import INFO, Event
from jfto_msgs_py.records.event import WARN as WARNED
from jfto_msgs_py.ros import qos, topics
from jfto_msgs_py.ros.air import ARRAY_OF_TOPIC, encode_air
from jfto_msgs_py.ros.diagnostics import OK, WARN, Status
from jfto_msgs_py.ros.graph_node import GraphNode
from jfto_msgs_py.ros.lift_off import lift_off_of
from jfto_msgs_py.ros.network import decode_adjacency
from jfto_msgs_py.ros.opening import Opening
from jfto_msgs_py.ros.stamps import decode_time
from jfto_msgs_py.scenario import Scenario
from jfto_sim.motion.waypoint_nav import warm_up
from jfto_sim.server import ServerSettings, SimServer
from jfto_world.terrain import Dem

# Where the stamp of a serialized message is that begins with a header: after the encoding's mark.
_STAMP = struct.Struct("<iI")
_STAMP_AT = 4
# What the fleet waits for after lift-off, and how far ahead the slots of a real one may begin.
_FIRST_SLOT = "the slots after lift-off"
_SOON_NS = 600 * 10**9


class SimulatedFleetNode(GraphNode[SimulatedFleetOptions]):
    """Flies a vehicle per UAV from the pads of the plan file; publishes /clock and /jfto/air/*.

    `dem_of` tells a scenario's terrain, None where nobody knows it. The vehicles outlive
    deactivation: only cleaning up, or the end of the process, takes them out of the air.
    """

    def __init__(
        self, dem_of: Callable[[Scenario], Dem | None] | None = None, **arguments: Any
    ) -> None:
        self._dem_of = dem_of
        self._link: Opening[SimServer] | None = None
        super().__init__("simulated_fleet", SimulatedFleetOptions, **arguments)

    def check(self, scenario: Scenario, options: SimulatedFleetOptions) -> None:
        """Refuse to be without pads."""
        del scenario
        if not options.plan_file:
            raise InputError("plan_file is empty. Name the plan whose pads the vehicles stand on.")

    def build(self, scenario: Scenario, options: SimulatedFleetOptions) -> None:
        """The clock, which runs from now on, with vehicles or without."""
        self._scenario, self._options = scenario, options
        self._fleet_time = FleetTime(options.speedup, options.start_time_s)
        self._last_ns = 0
        self._make_pace()
        self._ticks = self.create_lifecycle_publisher(ClockMessage, topics.CLOCK, qos.clock())
        self._air = {
            topic: self.create_lifecycle_publisher(Float64MultiArray, topic, qos.default())
            for topic in ARRAY_OF_TOPIC
        }
        self._told_ns = 0
        self.create_timer(
            1 / options.clock_rate_hz, self._tick, clock=Clock(clock_type=ClockType.STEADY_TIME)
        )

    def _make_pace(self) -> None:
        """What the graph reports of its time: nodes on a topic of their own, vehicles by poses."""
        self._pace = FleetPace(PaceSettings(patience_s=self._options.patience_s))
        self._given_up: frozenset[str] = frozenset()
        self._flight: PacedFlight | None = None
        if not self._options.patience_s:
            return
        self.create_subscription(Header, topics.CLOCK_TAKEN, self._on_report, qos.reports())
        self._lift_off_ns = self._told_lift_off_ns = 0
        self._plan_tag = ""
        self.create_subscription(Header, topics.LIFT_OFF, self._on_lift_off, qos.latched())
        self.create_subscription(
            UInt8MultiArray, topics.ADJACENCY, self._on_adjacency, qos.latched()
        )
        for uav in self._scenario.fleet.ids:
            self.create_subscription(
                PoseStamped,
                topics.pose(uav),
                partial(self._on_pose, uav),
                qos.sensor(),
                event_callbacks=SubscriptionEventCallbacks(matched=partial(self._on_source, uav)),
                raw=True,
            )

    def _on_report(self, message: Any) -> None:
        if message.frame_id != self.get_name():
            self._pace.node_at(message.frame_id, decode_time(message.stamp, "stamp"))

    def _on_lift_off(self, message: Any) -> None:
        """Wait for the slots that are counted from here: planner and topology are told anew."""
        decode = partial(lift_off_of, plan_tag=self._plan_tag)
        lift_off_ns = self.intake.take(topics.LIFT_OFF, decode, message)
        # A bridge that is started again tells the same once more.
        if lift_off_ns is not None and lift_off_ns != self._told_lift_off_ns:
            self._lift_off_ns = self._told_lift_off_ns = lift_off_ns
            self._pace.node_at(_FIRST_SLOT, lift_off_ns)

    def _on_adjacency(self, message: Any) -> None:
        if self._lift_off_ns:
            adjacency = self.intake.take(topics.ADJACENCY, decode_adjacency, message)
            # Slots of a lift-off that was only awaited lie an hour ahead.
            if adjacency and 0 <= adjacency.horizon.t0_ns - self._lift_off_ns < _SOON_NS:
                self._pace.forget(_FIRST_SLOT)
                self._lift_off_ns = 0

    def _on_pose(self, uav: str, data: bytes) -> None:
        seconds, nanoseconds = _STAMP.unpack_from(data, _STAMP_AT)
        self._pace.pose_at(uav, seconds * 10**9 + nanoseconds)

    def _on_source(self, uav: str, change: Any) -> None:
        """A bridge that comes anew knows nothing of what the one before was sent."""
        if change.current_count_change > 0:
            self._pace.pose_source(uav)

    def activated(self) -> None:
        """Power the vehicles up as soon as there is a plan."""
        if self._link is None:
            self._link = Opening(self._open, lambda _server: None, self._say)

    def released(self) -> None:
        """Take the vehicles away."""
        link, self._link = self._link, None
        if link is not None:
            link.close()

    def _open(self, stack: ExitStack) -> SimServer:
        """Vehicles on their pads; runs in the link's thread."""
        scenario, options = self._scenario, self._options
        errors = scenario.simulation
        path = Path(options.plan_file)
        if not path.exists():
            raise PlanError(f"{path} is not there yet.")
        plan = read_plan(path)
        self._plan_tag = plan_tag(plan)
        dem = None if self._dem_of is None else self._dem_of(scenario)
        # Before the time of power-up is read: an empty compiler cache takes a minute to fill.
        warm_up()
        boot_ns = self._fleet_time.now_ns() - round(UPTIME_S * 1e9)
        configs = vehicle_configs(plan, boot_ns, errors, dem)
        settings = ServerSettings(
            ((options.endpoint,),) * len(configs),
            options.speedup,
            errors.seed,
            options.faults,
            options.control_port or None,
            UPTIME_S,
        )
        names = {config.sysid: uav.id for config, uav in zip(configs, plan.uavs, strict=True)}
        pace = partial(self._grant, names) if options.patience_s else None
        air = fleet_air(plan, errors, dem)
        server = stack.enter_context(SimServer(configs, settings, air, pace))
        self._fleet_time.follow(server, boot_ns)
        count, endpoint = len(configs), options.endpoint
        self.get_logger().info(f"{count} vehicles on their pads send to {endpoint}")
        return server

    def _grant(self, names: dict[int, str], server: SimServer, passed_s: float) -> float:
        """By how much the vehicles' time may go on; called in their thread."""
        sent_ns = {names[number]: one.position_ns for number, one in server.stations.items()}
        now_ns, wall_s = self._fleet_time.now_ns(), time.monotonic()
        self._flight = self._pace.look(now_ns, wall_s, flying=server.armed) or self._flight
        return self._pace.grant(now_ns, sent_ns, wall_s, passed_s)

    def _tell_pace(self) -> None:
        """Tell for whom nobody waits any more, and in the end how fast the flight was."""
        given_up, before = self._pace.given_up, self._given_up
        self._given_up = given_up
        # On the ground a node may well compile for a minute.
        for name in given_up - before if self._pace.flying else ():
            patience = f"{self._options.patience_s:g} s"
            text = f"{name} did not come on in {patience}: the vehicles' time goes on at real time."
            self.announce(Event(WARNED, "pace", "", text))
        flight, self._flight = self._flight, None
        if flight is not None:
            self.announce(Event(INFO, "pace", "", _summary(flight, self._options.speedup)))

    def _say(self, note: str) -> None:
        self.get_logger().warning(f"No vehicles: {note}")

    def _tick(self) -> None:
        if not self.is_active:
            return
        self._last_ns = max(self._last_ns, self._fleet_time.now_ns())
        self._ticks.publish(ClockMessage(clock=Time(nanoseconds=self._last_ns).to_msg()))
        self._tell_air()
        self._tell_pace()

    def _tell_air(self) -> None:
        """Publish the last report of the air, once."""
        link = self._link
        carried = None if link is None or link.opened is None else link.opened.air
        report = None if carried is None else carried.latest
        if report is None or report.stamp_ns == self._told_ns:
            return
        self._told_ns = report.stamp_ns
        for topic, message in encode_air(report).items():
            self._air[topic].publish(message)

    def statuses(self, now_ns: int) -> list[Status]:
        """Whether the vehicles are there, and by how much their time is ahead of the wall's."""
        facts = {"speedup": f"{self._options.speedup:g}"}
        facts["ahead_of_wall_s"] = f"{now_ns / 1e9 - time.time():.1f}"
        link = self._link
        if link is None or link.opened is None:
            note = "not active" if link is None else link.note
            return [Status("", WARN, f"no vehicles: {note}", facts)]
        count = len(link.opened.stations)
        if self._given_up:
            self._forget_the_gone()
            names = ", ".join(sorted(self._given_up))
            return [Status("", WARN, f"{count} vehicles, not waiting for {names}", facts)]
        return [Status("", OK, f"{count} vehicles", facts)]

    def _forget_the_gone(self) -> None:
        """Whoever reports no more since it has left the graph is no reason to be slow."""
        reporting = {
            each.node_name for each in self.get_publishers_info_by_topic(topics.CLOCK_TAKEN)
        }
        for name in self._given_up - reporting:
            self._pace.forget(name)


def _summary(flight: PacedFlight, asked: float) -> str:
    """How fast a flight was, and for whom it waited."""
    text = f"The vehicles' time passed ×{flight.speed:.1f} of {asked:g} asked"
    if not flight.waited_s:
        return f"{text}; it waited for nobody."
    longest = sorted(flight.waited_s.items(), key=lambda each: -each[1])
    waits = ", ".join(f"{name} {waited_s:.1f} s" for name, waited_s in longest[:3])
    return f"{text}; it waited for {waits}."
