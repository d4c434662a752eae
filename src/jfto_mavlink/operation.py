"""A fleet in operation: its plan read, its links open, its orders, its flight watched.

Knows no ROS: a node hands in its time and what it wants to be told.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

from jfto_mavlink.errors import LinkError, MavlinkError, RosterError
from jfto_mavlink.fleet.fly import Fleet, Reporter
from jfto_mavlink.fleet.link import FleetLink
from jfto_mavlink.fleet.orders import FleetOrders, OrderSettings
from jfto_mavlink.fleet.roster import Roster, parse_vehicles
from jfto_mavlink.fleet.station import StationSettings
from jfto_mavlink.fleet.watched_flight import Recognised, WatchedFlight, recognise_all
from jfto_mavlink.flight.follow import Moment
from jfto_mavlink.flight.telemetry import LinkState, Measurement, PositionSample, Sample, listen
from jfto_mavlink.guided.orders import GuidedOrders
from jfto_mavlink.guided.scheduler import GuidedSettings
from jfto_mavlink.guided.target import MapFrame
from jfto_mavlink.io.signing import load_signer
from jfto_mavlink.mission.build import VehicleMission, build_missions
from jfto_mavlink.mission.changed import ChangedParameters
from jfto_mavlink.mission.limits import Ground, MissionLimits
from jfto_mavlink.mission.settings import (
    MissionSettings,
    require_times_for_gates,
    settings_for,
)
from jfto_mavlink.options import BridgeOptions
from jfto_mavlink.preflight.page import Preflight, write_page
from jfto_mavlink.preflight.settings import GateSettings, gate_settings
from jfto_mavlink.protocol.exchange import Context
from jfto_mavlink.protocol.setup import rates_for
from jfto_mavlink.protocol.timesync import PacedClock
from jfto_msgs_py.errors import JftoError, PlanError
from jfto_msgs_py.plan_file import plan_tag, read_plan
from jfto_msgs_py.records.event import ERROR, INFO, Event
from jfto_msgs_py.records.plan import Plan
from jfto_msgs_py.records.vehicle import VehiclePose
from jfto_msgs_py.scenario import Scenario
from jfto_world.motion.arducopter.takeoff import SPOOL_UP_S
from jfto_world.terrain.frame import LocalFrame

NS = 1_000_000_000
# Between two tries to put parameters back.
RESTORE_EVERY_S = 15.0
# What comes in from other threads than the node's.
Incoming = Sample | Event | Recognised


@dataclass(frozen=True)
class NodeSide:
    """The node's time, and what it is told: `incoming` and `report` in threads of the link.

    `now_ns` is the graph's time, `clock` the same in seconds where vehicles are to keep it, None
    where they keep the wall's. `lift_off` is called with the plan's tag and
    the fleet's time zero (ns).
    """

    now_ns: Callable[[], int]
    clock: PacedClock | None
    incoming: Callable[[Incoming], None]
    report: Reporter
    tell: Callable[[Event], None]
    lift_off: Callable[[str, int], None]


def real_roster(options: BridgeOptions, uavs: tuple[str, ...]) -> Roster:
    """Roster of the vehicles that the parameters name; raises RosterError."""
    roster = parse_vehicles(options.roster, uavs, options.endpoints)
    if roster is None:
        raise RosterError(
            201,
            "roster is sim; mavlink_bridge simulates no vehicles. Start simulated_fleet, and name "
            "the link that it sends to.",
        )
    return roster


def open_operation(
    stack: ExitStack,
    scenario: Scenario,
    options: BridgeOptions,
    ground: Callable[[], Ground] | None,
    node: NodeSide,
) -> Operation:
    """Read the plan of a fleet, build its missions and open its links, vehicles heard or not.

    With `ground` (the scenario's terrain) missions must clear it. Raises LinkError, MissionError,
    PlanError, RosterError or SigningError.
    """
    if options.vehicle_stamps and node.now_ns() == 0:
        raise LinkError(103, "/clock is not there yet.")
    path = Path(options.plan_file)
    if not path.exists():
        raise PlanError(f"{path} is not there yet.")
    plan = read_plan(path)
    ids, uavs = tuple(uav.id for uav in plan.uavs), scenario.fleet.ids
    if ids != uavs:
        raise PlanError(
            f"{path} is for {', '.join(ids)}, the scenario for {', '.join(uavs)}. Give both the "
            "same fleet."
        )
    settings = mission_settings(plan, options)
    known_ground = None if ground is None else ground()
    built = build_missions(plan, settings, ground=known_ground)
    link = stack.enter_context(
        FleetLink(
            real_roster(options, ids),
            StationSettings(
                signer=load_signer(Path(options.key_file)) if options.key_file else None,
                rates=rates_for(options.telemetry_rate_hz, options.speedup),
                log_directory=Path(options.log_directory) if options.log_directory else None,
            ),
            clock=node.clock,
            unix=node.clock or time.time,
            on_event=node.incoming,
        )
    )
    fleet = Fleet(
        link,
        {mission.uav: mission for mission in built},
        node.report,
        ChangedParameters(Path(options.parameters_file) if options.parameters_file else None),
        partial(_keep_page, options.preflight_file),
    )
    gate = gate_settings(
        *(plan, scenario, known_ground),
        guided=bool(plan.trajectories),
        by_the_clock=bool(options.gates),
    )
    chosen = _order_settings(gate, options, node)
    orders = FleetOrders(fleet, chosen)
    # A plan that was certified for curves is never flown as missions.
    if plan.trajectories:
        guided = GuidedSettings(take_off_m=settings.takeoff_height_m)
        state_file = Path(options.state_file) if options.state_file else None
        tell = node.incoming
        orders = GuidedOrders(fleet, chosen, plan, node.now_ns, guided, state_file, tell)
    return Operation(plan, link, orders, options, node)


def mission_settings(plan: Plan, options: BridgeOptions) -> MissionSettings:
    """How the parameters want the missions of a plan; raises MissionError."""
    if options.gates:
        require_times_for_gates(plan)
    return settings_for(
        plan,
        style=None if options.style == "planned" else options.style,
        pass_within_m=options.pass_within_m,
        takeoff_height_m=options.takeoff_height_m or None,
        return_height_m=options.return_height_m or None,
        gates=tuple(gate - 1 for gate in options.gates),
        start_unix_s=options.start_at_s or None,
        limits=mission_limits(options),
    )


def mission_limits(options: BridgeOptions) -> MissionLimits:
    """What the parameters allow a mission to hold."""
    return MissionLimits(
        height_min_m=options.height_min_m,
        height_max_m=options.height_max_m,
        distance_max_m=options.distance_max_m,
    )


def _keep_page(file: str, page: Preflight) -> None:
    if file:
        write_page(page, Path(file))


def _order_settings(gate: GateSettings, options: BridgeOptions, node: NodeSide) -> OrderSettings:
    """Orders that keep to the time gates, where there are any."""
    chosen = OrderSettings(options.allow_arming, options.abort_by_landing, gate)
    if not options.gates:
        return chosen
    unix = node.clock or time.time

    def away_s() -> float:
        # Times count from lift-off, to which the rotors take their time from the start on.
        return options.start_at_s - SPOOL_UP_S - unix()

    return replace(chosen, start_away_s=away_s)


class Operation:
    """A fleet with its links open. Its methods but `own_s` are called in the node's executor."""

    def __init__(
        self,
        plan: Plan,
        link: FleetLink,
        orders: FleetOrders,
        options: BridgeOptions,
        node: NodeSide,
    ) -> None:
        self.plan, self.link, self.orders = plan, link, orders
        self._node, self._speedup = node, options.speedup
        self._is_stamped_by_vehicles = options.vehicle_stamps
        self._restore_from_s = 0.0
        frame = LocalFrame(plan.origin)
        missions = orders.missions
        self._maps = {uav: MapFrame(frame, m.home_deg_m[2]) for uav, m in missions.items()}
        self.states: dict[str, LinkState] = {}
        self.flight = WatchedFlight(
            missions,
            Path(options.state_file) if options.state_file else None,
            link.lost_after_s,
            node.tell,
            partial(node.lift_off, plan_tag(plan)),
            self,
            guided=orders.guided,
        )

    def begin(self) -> None:
        """Listen to the vehicles, and find out what they are doing."""
        self.flight.begin()
        missions: dict[str, VehicleMission] = self.orders.missions
        streamed = self.orders.guided
        for uav, mission in missions.items():
            job = partial(
                listen,
                mission=mission,
                sink=self._node.incoming,
                under_way=self._streamed_since if streamed else self.flight.under_way,
                elapsed_s=self._streamed_s if streamed else None,
            )
            self.link.start(uav, job)
        if streamed:
            threading.Thread(target=self._pick_up, name="pick up", daemon=True).start()
        recognise_all(self.link, missions, self._node.incoming)

    def _pick_up(self) -> None:
        try:
            self.orders.pick_up()
        except MavlinkError as error:
            self._node.incoming(Event(ERROR, "guided", "", str(error)))

    def _streamed_s(self) -> float | None:
        progressed = self.orders.progressed()
        return None if progressed is None else progressed.elapsed_s

    def _streamed_since(self, context: Context) -> float | None:
        progressed = self.orders.progressed()
        return None if progressed is None else self.own_s(context, progressed.zero_ns)

    def take(self, one: LinkState | Recognised) -> None:
        """Take in what a vehicle does, or was found doing at the beginning."""
        if isinstance(one, Recognised):
            self.flight.found(one)
            return
        self.states[one.uav] = one
        self.flight.take(one)
        self._put_back(one.at_s)

    def _put_back(self, now_s: float) -> None:
        """Once nobody flies, give vehicles the parameters that they had before the flight."""
        changed = self.orders.fleet.changed.vehicles
        if not changed or now_s < self._restore_from_s or not self.flight.down or self.orders.busy:
            return
        self._restore_from_s = now_s + RESTORE_EVERY_S
        threading.Thread(target=self._restore, name="restore", daemon=True).start()

    def _restore(self) -> None:
        before = self.orders.fleet.changed.vehicles
        try:
            event = Event(INFO, "parameters", "", self.orders.restore())
        except JftoError as error:
            event = Event(ERROR, "parameters", "", str(error))
        if event.level == ERROR or self.orders.fleet.changed.vehicles != before:
            self._node.incoming(event)

    @property
    def phase(self) -> str:
        """What the fleet is at, in a word or two, for whoever gives orders."""
        monitor = self.flight.monitor
        if monitor.over:
            return "over"
        if not any(state.in_flight for state in self.states.values()):
            return "on the ground"
        return "held" if self.orders.held else "in flight"

    def pose(self, sample: PositionSample, stamp_ns: int) -> VehiclePose:
        """A position on the plan's map."""
        place = self._maps[sample.uav].position_m(sample.lat_deg, sample.lon_deg, sample.height_m)
        here = (float(place[0]), float(place[1]), float(place[2]))
        return VehiclePose(stamp_ns, here, sample.yaw_deg)

    def stamp_ns(self, sample: Measurement | Moment) -> int | None:
        """When a sample was true on the graph's clock; None while nobody can tell."""
        if self._is_stamped_by_vehicles:
            return sample.utc_ns
        age_s = max(self.link.clock() - sample.at_s, 0.0) / self.link.clock.speedup
        return self._node.now_ns() - round(age_s * NS)

    def begun_ns(self, moment: Moment) -> int | None:
        """Time zero of a flight that began at a moment: what is streamed has it in its stamps."""
        return self.orders.begun_ns(lambda: self.stamp_ns(moment))

    def own_s(self, context: Context, at_ns: int) -> float | None:
        """A time of the graph's on a vehicle's own clock; called in the link's thread."""
        if self._is_stamped_by_vehicles:
            return context.vehicle.boot_s(at_ns)
        gone_s = (self._node.now_ns() - at_ns) / NS * self._speedup
        return context.vehicle.own_time_s(context.clock()) - gone_s
