"""The bridge in the graph: vehicles' poses, fixes, batteries and health, and orders to them."""

from __future__ import annotations

import threading
import time
from collections import deque
from collections.abc import Callable, Mapping
from contextlib import ExitStack
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from builtin_interfaces.msg import Time
from geometry_msgs.msg import PoseStamped
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.task import Future
from sensor_msgs.msg import BatteryState, NavSatFix
from std_srvs.srv import Trigger
from trajectory_msgs.msg import MultiDOFJointTrajectory

from jfto_mavlink.errors import LinkError, MavlinkError, MissionError, RosterError
from jfto_mavlink.fleet.changes import Event
from jfto_mavlink.fleet.link import FleetLink
from jfto_mavlink.fleet.orders import FleetOrders, OrderSettings
from jfto_mavlink.fleet.watched_flight import Found, WatchedFlight, recognise_all
from jfto_mavlink.flight.follow import Moment
from jfto_mavlink.flight.telemetry import (
    BatterySample,
    FixSample,
    LinkState,
    Measurement,
    PositionSample,
    Sample,
    listen,
)
from jfto_mavlink.guided.orders import GuidedOrders
from jfto_mavlink.guided.target import MapFrame
from jfto_mavlink.mission.build import VehicleMission, build_missions
from jfto_mavlink.mission.limits import Ground
from jfto_mavlink.mission.settings import MissionSettings, settings_for
from jfto_mavlink.named_vehicles import read_roster, simulated_count
from jfto_mavlink.open_vehicles import FleetRequest, OpenSimulated, open_real, rates
from jfto_mavlink.options import BridgeOptions
from jfto_mavlink.protocol.exchange import Context, Report
from jfto_mavlink.ros_messages import Expected, encode_battery, encode_fix, node_status, uav_status
from jfto_msgs_py.errors import InputError, JftoError, PlanError
from jfto_msgs_py.plan import Plan
from jfto_msgs_py.plan_file import read_plan
from jfto_msgs_py.ros import qos, topics
from jfto_msgs_py.ros.diagnostics import Status
from jfto_msgs_py.ros.graph_node import GraphNode
from jfto_msgs_py.ros.opening import Opening
from jfto_msgs_py.ros.stamps import encode_time
from jfto_msgs_py.ros.ticked_clock import TickedClock
from jfto_msgs_py.ros.vehicle import decode_trajectory, encode_pose
from jfto_msgs_py.scenario import Scenario
from jfto_msgs_py.vehicle import VehiclePose
from jfto_world.terrain.frame import LocalFrame

# How often the source of a streamed trajectory is looked for.
CONFIRM_S = 0.2
SAMPLES_KEPT = 5000


@dataclass(frozen=True)
class Opened:
    """All that there is once the plan is read and the links are open."""

    plan: Plan
    bridge: FleetLink
    maps: dict[str, MapFrame]
    desk: FleetOrders
    flight: WatchedFlight


News = Sample | Event | Opened | Found


class MavlinkBridgeNode(GraphNode[BridgeOptions]):
    """Speaks with the vehicles of a plan; what is slow happens in threads of its own.

    `open_simulated` makes simulated vehicles, `ground_of` knows a scenario's terrain.
    """

    answers_later = True

    def __init__(
        self,
        open_simulated: OpenSimulated | None = None,
        ground_of: Callable[[Scenario], Ground] | None = None,
        **arguments: Any,
    ) -> None:
        self._open_simulated, self._ground_of = open_simulated, ground_of
        self._link: Opening[Opened] | None = None
        self._samples: deque[News] = deque(maxlen=SAMPLES_KEPT)
        self._answers: deque[tuple[Future, bool, str]] = deque()
        self._waiting: list[Future] = []
        self._states: dict[str, LinkState] = {}
        self._trajectories: dict[str, Any] = {}
        self._trouble: dict[str, str] = {}
        # Threads of ours wake the executor only while there is what they wake.
        self._waking = threading.Lock()
        self._news: Any = None
        self._time: TickedClock | None = None
        super().__init__("mavlink_bridge", BridgeOptions, **arguments)

    def check(self, scenario: Scenario, options: BridgeOptions) -> None:
        """Refuse rosters that are not the fleet's, and what cannot be flown."""
        if not options.plan_file:
            raise InputError("plan_file is empty. Name the plan that the vehicles fly.")
        count = simulated_count(options)
        if count is None:
            read_roster(options, scenario.fleet.ids)
            if options.speedup != 1.0 and not options.vehicle_stamps:
                raise InputError(
                    f"speedup is {options.speedup}; real vehicles keep time. Set vehicle_stamps "
                    "where others simulate them."
                )
        elif self._open_simulated is None:
            raise InputError("roster is sim:N, and this node cannot simulate. Name real vehicles.")
        elif count != len(scenario.fleet.ids):
            raise RosterError(
                201, f"roster is sim:{count}, the fleet has {len(scenario.fleet.ids)} UAVs."
            )
        if options.guided and options.speedup != 1.0:
            raise InputError("speedup must be 1 with guided: trajectories are in real time.")

    def build(self, scenario: Scenario, options: BridgeOptions) -> None:
        """Publishers per UAV, services, and the way for news from other threads."""
        self._scenario, self._options = scenario, options
        ids = scenario.fleet.ids

        def per_uav(kind: Any, name: Callable[[str], str]) -> dict[str, Any]:
            return {u: self.create_lifecycle_publisher(kind, name(u), qos.sensor()) for u in ids}

        self._poses = per_uav(PoseStamped, topics.pose)
        self._fixes = per_uav(NavSatFix, topics.fix)
        self._batteries = per_uav(BatteryState, topics.battery)
        self._lift_off = self.create_lifecycle_publisher(Time, topics.LIFT_OFF, qos.latched())
        for uav in ids:
            self.create_subscription(
                MultiDOFJointTrajectory,
                topics.trajectory(uav),
                partial(self._on_trajectory, uav),
                qos.latched(),
            )
        group = ReentrantCallbackGroup()
        for name in topics.MISSION_SERVICES:
            verb = name.rpartition("/")[2]
            self.create_service(Trigger, name, partial(self._on_order, verb), callback_group=group)
        if options.guided:
            self.create_timer(CONFIRM_S, self._confirm)
        self._news = self.create_guard_condition(self._on_news)
        self._time = TickedClock(self.get_clock(), options.speedup)

    def activated(self) -> None:
        """Open the links if they are not."""
        if self._opened is not None:
            self._opened.flight.begin()
        if self._link is None:
            self._link = Opening(self._open, self._keep, self._say)

    def deactivated(self) -> None:
        """Publish nothing, and stop what is streamed to; links stay, for vehicles miss stations."""
        opened = self._opened
        if opened is not None:
            threading.Thread(target=self._end_desk, args=(opened.desk,), daemon=True).start()

    def released(self) -> None:
        """Stop what is streamed to and close the links."""
        link, self._link = self._link, None
        if link is not None:
            if link.opened is not None:
                self._end_desk(link.opened.desk)
            link.close()
        if self._time is not None:
            self._time.close()
            self._time = None
        with self._waking:
            self._news = None
        for answer in self._waiting:
            answer.set_result((False, "The bridge was cleaned up."))
        self._waiting.clear()
        self._answers.clear()
        self._samples.clear()
        self._states.clear()
        self._trouble.clear()

    @property
    def _opened(self) -> Opened | None:
        return None if self._link is None else self._link.opened

    def _open(self, stack: ExitStack) -> Opened:
        """Plan, missions and links; runs in the link's thread."""
        scenario, options = self._scenario, self._options
        assert self._time is not None
        now_ns = self._time.now_ns
        if options.vehicle_stamps and now_ns() == 0:
            raise LinkError(103, "/clock is not there yet.")
        path = Path(options.plan_file)
        if not path.exists():
            raise PlanError(f"{path} is not there yet.")
        plan = read_plan(path)
        ids = tuple(uav.id for uav in plan.uavs)
        if ids != scenario.fleet.ids:
            raise PlanError(
                f"{path} is for {', '.join(ids)}, the scenario for "
                f"{', '.join(scenario.fleet.ids)}. Give both the same fleet."
            )
        missions = self._missions(plan)
        count = simulated_count(options)
        request = FleetRequest(
            plan,
            {uav: mission.home_deg_m for uav, mission in missions.items()},
            count or 0,
            options.speedup,
            rates(options),
            Path(options.log_directory) if options.log_directory else None,
            self._keep,
            self._time if options.vehicle_stamps else None,
            self._time if options.vehicle_stamps else time.time,
        )
        if count is None:
            bridge = open_real(stack, options, read_roster(options, ids), request)
        else:
            assert self._open_simulated is not None
            bridge = stack.enter_context(self._open_simulated(request))
        frame = LocalFrame(plan.origin)
        maps = {u: MapFrame(frame, m.home_deg_m[2]) for u, m in missions.items()}
        settings = OrderSettings(
            count is not None or options.allow_arming, options.abort_by_landing
        )
        desk = FleetOrders(bridge, missions, settings, self._report)
        if options.guided:
            height_m = self._mission_settings(plan).takeoff_height_m
            desk = GuidedOrders(bridge, missions, settings, self._report, plan, now_ns, height_m)
        flight = self._make_flight(bridge, missions)
        for uav, mission in missions.items():
            job = partial(listen, mission=mission, sink=self._keep, under_way=flight.under_way)
            bridge.start(uav, job)
        recognise_all(bridge, missions, self._keep)
        return Opened(plan, bridge, maps, desk, flight)

    def _make_flight(
        self, bridge: FleetLink, missions: Mapping[str, VehicleMission]
    ) -> WatchedFlight:
        options = self._options
        return WatchedFlight(
            missions,
            Path(options.state_file) if options.state_file else None,
            bridge.station.lost_after_s,
            self.announce,
            lambda begun_ns: self._lift_off.publish(encode_time(begun_ns)),
            partial(self._begun_ns, bridge),
            self._own_s,
        )

    def _mission_settings(self, plan: Plan) -> MissionSettings:
        options = self._options
        return settings_for(
            plan,
            style=None if options.style == "planned" else options.style,
            pass_within_m=options.pass_within_m,
            takeoff_height_m=options.takeoff_height_m or None,
        )

    def _missions(self, plan: Plan) -> dict[str, VehicleMission]:
        options = self._options
        settings = self._mission_settings(plan)
        ground = None
        if options.check_terrain and self._ground_of is not None:
            ground = self._ground_of(self._scenario)
        return {mission.uav: mission for mission in build_missions(plan, settings, ground=ground)}

    def _keep(self, news: News) -> None:
        """Hand news to the executor; called in other threads."""
        self._samples.append(news)
        self._wake()

    def _wake(self) -> None:
        with self._waking:
            if self._news is not None:
                self._news.trigger()

    def _say(self, note: str) -> None:
        self.get_logger().warning(f"Not linked: {note}")

    def _report(self, uav: str, step: Report) -> None:
        if not step.total:
            # Steps that can be counted are too many for a log.
            self.get_logger().info(f"{uav}: {step.text}")

    def _on_news(self) -> None:
        """Publish what came in, and answer services that are done."""
        while self._answers:
            answer, success, text = self._answers.popleft()
            if answer in self._waiting:
                self._waiting.remove(answer)
                answer.set_result((success, text))
        while self._samples:
            news = self._samples.popleft()
            opened = self._opened
            if isinstance(news, LinkState):
                self._states[news.uav] = news
                if opened is not None:
                    opened.flight.take(news)
            elif isinstance(news, Found):
                if opened is not None:
                    opened.flight.found(news)
            elif isinstance(news, Event):
                self.get_logger().info(f"{news.uav}: {news.text}")
            elif isinstance(news, Opened):
                news.flight.begin()
                for uav in list(self._trajectories):
                    self._pass_on(uav)
            elif opened is not None and self.is_active:
                self._publish(opened, news)

    def _publish(self, opened: Opened, sample: Measurement) -> None:
        stamp_ns = self._stamp_ns(opened.bridge, sample)
        if stamp_ns is None or stamp_ns < 0:
            # Simulated time has not begun.
            return
        if isinstance(sample, PositionSample):
            place = opened.maps[sample.uav].position_m(
                sample.lat_deg, sample.lon_deg, sample.height_m
            )
            here = (float(place[0]), float(place[1]), float(place[2]))
            pose = VehiclePose(stamp_ns, here, sample.yaw_deg)
            self._poses[sample.uav].publish(encode_pose(pose))
        elif isinstance(sample, FixSample):
            self._fixes[sample.uav].publish(encode_fix(sample, stamp_ns))
        elif isinstance(sample, BatterySample):
            self._batteries[sample.uav].publish(encode_battery(sample, stamp_ns))

    def _begun_ns(self, bridge: FleetLink, moment: Moment) -> int | None:
        """Time zero of the flight: what is streamed has it in its stamps."""
        if self._options.guided:
            return min((t.start_ns for t in self._trajectories.values()), default=None)
        return self._stamp_ns(bridge, moment)

    def _own_s(self, context: Context, at_ns: int) -> float | None:
        """A time of this node on a vehicle's own clock; called in the bridge's thread."""
        vehicle = context.vehicle
        if self._options.vehicle_stamps:
            return vehicle.boot_s(at_ns)
        gone_s = (self.now_ns() - at_ns) / 1e9 * self._options.speedup
        return vehicle.own_time_s(context.clock()) - gone_s

    def _stamp_ns(self, bridge: FleetLink, sample: Measurement | Moment) -> int | None:
        """When a sample was true on the node's clock; None while nobody can tell."""
        if self._options.vehicle_stamps:
            return sample.utc_ns
        age_s = max(bridge.clock() - sample.at_s, 0.0) / bridge.clock.speedup
        return self.now_ns() - round(age_s * 1e9)

    def _on_trajectory(self, uav: str, message: Any) -> None:
        trajectory = self.intake.take(topics.trajectory(uav), decode_trajectory, message)
        if trajectory is not None:
            self._trajectories[uav] = trajectory
            self._pass_on(uav)

    def _pass_on(self, uav: str) -> None:
        opened = self._opened
        if opened is None or not isinstance(opened.desk, GuidedOrders):
            return
        self._trouble.pop(uav, None)
        try:
            opened.desk.take(uav, self._trajectories[uav])
        except MissionError as error:
            self._trouble[uav] = str(error)
            self.get_logger().error(str(error))

    def _confirm(self) -> None:
        """Tell the streams that somebody still offers the trajectories."""
        opened = self._opened
        if opened is None or not isinstance(opened.desk, GuidedOrders) or not self.is_active:
            return
        for uav in self._trajectories:
            if self.count_publishers(topics.trajectory(uav)):
                opened.desk.confirm(uav)

    async def _on_order(self, verb: str, request: Any, response: Any) -> Any:
        """Carry out an order in a thread; answers with what was done, or the numbered error."""
        del request
        opened = self._opened
        if not self.is_active:
            response.message = "The bridge is not active. Activate it first."
        elif opened is None:
            note = "" if self._link is None else self._link.note
            response.message = f"The vehicles are not linked yet: {note}"
        else:
            answer: Future = Future()
            self._waiting.append(answer)
            work = (answer, getattr(opened.desk, verb))
            threading.Thread(target=self._obey, args=work, name=verb, daemon=True).start()
            response.success, response.message = await answer
        return response

    def _obey(self, answer: Future, order: Callable[[], str]) -> None:
        try:
            done = (answer, True, order())
        except JftoError as error:
            done = (answer, False, str(error))
        except Exception as error:  # noqa: BLE001  whoever asked is told
            done = (answer, False, f"{type(error).__name__}: {error}")
        self._answers.append(done)
        self._wake()

    def _end_desk(self, desk: FleetOrders) -> None:
        try:
            desk.close()
        except MavlinkError as error:
            self.get_logger().error(str(error))

    def statuses(self, now_ns: int) -> list[Status]:
        """The link as a whole, and each vehicle."""
        del now_ns
        opened = self._opened
        note = "not active" if self._link is None else self._link.note
        node = node_status(note, self._options.guided, self.intake.facts("/"))
        if opened is None:
            return [node, *(Status(uav, node.level, note) for uav in self._scenario.fleet.ids)]
        found = [node]
        for uav in self._scenario.fleet.ids:
            track = opened.bridge.station.tracks[uav]
            stream = opened.desk.streaming(uav) if isinstance(opened.desk, GuidedOrders) else ""
            conflict = track.identity.conflict or track.identity.wrong_vehicle
            trouble = conflict or self._trouble.get(uav, "")
            expected = Expected(opened.plan.slots.duration_s / 4, trouble, stream)
            found.append(uav_status(uav, self._states.get(uav), opened.bridge.clock(), expected))
        return found
