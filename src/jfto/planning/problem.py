"""A scenario over its ground as the search takes it: pads, limits, reach and legs."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from scipy.sparse.csgraph import connected_components

from jfto.planning.endurance import battery_of, latest_arrivals_s
from jfto.planning.fence import corner_allowance_m
from jfto.planning.flight import flight_of
from jfto.planning.network import energy_floor_of
from jfto.planning.speeds import fleet_limits
from jfto.planning.survey import Survey
from jfto_msgs_py.errors import InfeasibleError
from jfto_msgs_py.plan_file import rounded_record
from jfto_msgs_py.records.plan import Uav, Vector, Waypoint
from jfto_msgs_py.scenario import Scenario
from jfto_msgs_py.types import Array, Flags
from jfto_msgs_py.units import dbm_to_w
from jfto_planner.home import HomeRules
from jfto_planner.low_legs import low_legs
from jfto_planner.routing import RoutingProblem
from jfto_planner.routing.certificate import GroundRule
from jfto_planner.routing.certificate.mission_size import photo_capacity
from jfto_planner.routing.detours import Detours, detours_of
from jfto_planner.starts import check_starts, choose_starts, place_pads
from jfto_world.motion import MotionLimits
from jfto_world.radio import make_channel
from jfto_world.terrain import Dem

if TYPE_CHECKING:
    from jfto_world.site.free_space import FreeSpace

# Of the height of lift-off, what a first leg must keep above the ground until it is high enough.
START_SHARE = 0.5


def routing_problem(scenario: Scenario, found: Survey) -> RoutingProblem:
    """The routing problem of a scenario; raises InfeasibleError where its starts cannot serve."""
    fleet, mission, network = scenario.fleet, scenario.mission, scenario.network
    radio = scenario.radio
    channel, reach = make_channel(radio), _reach_m(scenario)
    waypoints = np.array([waypoint.position_m for waypoint in found.waypoints])
    flight = flight_of(scenario)
    pads = pads_of(scenario, found)
    if flight.estimated:
        pads = np.array(rounded_record(pads))
    check_starts(pads, reach, network.k_min, mission.d_min_m, fleet.ids)
    uavs = plan_uavs(scenario, found, pads)
    closed, detours = _legs(scenario, found, waypoints, pads)
    return RoutingProblem(
        waypoints_m=waypoints,
        starts_m=pads,
        limits=tuple(MotionLimits(uav.speed_mps, uav.climb_mps, uav.descent_mps) for uav in uavs),
        time_model=flight.model(),
        t_max_s=np.array([uav.t_max_s for uav in uavs]),
        reach_m=reach,
        k_min=network.k_min,
        d_min_m=mission.d_min_m,
        length_max_m=mission.length_max_m,
        slot_count=mission.slot_count,
        horizon_s=mission.horizon_s or None,
        energy_j=np.array(fleet.energy_j),
        energy_floor=energy_floor_of(radio, fleet.p_max_dbm, network.k_min, network.delta),
        path_loss_exponent=channel.exponent,
        closed_legs=closed,
        detours=detours,
        most_waypoints=np.array(
            [photo_capacity(found.waypoints, fleet.count, fleet.mission_items)], dtype=np.float64
        ),
    )


def ground_rule(scenario: Scenario, surveyed: Sequence[Waypoint], dem: Dem) -> GroundRule | None:
    """What height above ground the plan must keep; waypoints that are lower are let be."""
    wanted = scenario.trajectory
    if wanted.mode == "straight":
        return None
    waypoints = np.array([waypoint.position_m for waypoint in surveyed])
    ground = dem.top_height(waypoints[:, 0], waypoints[:, 1])
    clearance_m = min(wanted.clearance_m, float(np.min(waypoints[:, 2] - ground)))
    start_m = wanted.takeoff_m if wanted.mode == "waypoints" else clearance_m
    return GroundRule(dem.top_height, clearance_m, START_SHARE * min(start_m, clearance_m))


def home_rules(scenario: Scenario, found: Survey) -> HomeRules:
    """What ways home keep to: trajectory.clearance_m, in every mode."""
    clearance_m = scenario.trajectory.clearance_m
    return HomeRules(found.dem.top_height, clearance_m, free_space(scenario, found))


def home_ground(scenario: Scenario, dem: Dem) -> GroundRule:
    """The same for the certificate."""
    clearance_m = scenario.trajectory.clearance_m
    return GroundRule(dem.top_height, clearance_m, clearance_m)


def free_space(scenario: Scenario, found: Survey) -> FreeSpace | None:
    """Where may be flown, with what corners take of the way round; None without a fence."""
    if found.fence is None:
        return None
    # Loads shapely, which only plans with a fence need.
    from jfto_world.site.free_space import FreeSpace

    return FreeSpace(found.fence, corner_allowance_m(scenario.trajectory))


def _legs(
    scenario: Scenario, found: Survey, waypoints: Array, pads: Array
) -> tuple[Flags | None, Detours | None]:
    """Legs that must not be flown, and those that go round no-fly zones.

    Legs of missions keep their height above the ground; curves get via points instead. Raises
    InfeasibleError for pads in zones and waypoints that no way leads to.
    """
    rule = ground_rule(scenario, found.waypoints, found.dem)
    mission = scenario.trajectory.mode == "waypoints"
    above = pads + np.array([0.0, 0.0, scenario.trajectory.takeoff_m if mission else 0.0])
    low: Flags | None = None
    if rule is not None and mission:
        low = low_legs(waypoints, above, rule.height, rule.clearance_m, rule.start_clearance_m)
    free = free_space(scenario, found)
    if free is None:
        return low, None
    _require_free_pads(free, scenario.fleet.ids, pads)
    ground = rule.height if rule is not None and mission else None
    detours, closed = detours_of(
        free,
        np.concatenate([waypoints, above]),
        pads,
        ground,
        rule.clearance_m if rule is not None else 0.0,
    )
    _require_reached(closed, found, len(pads))
    if low is not None:
        closed |= low & (detours.index < 0)
    return closed, detours


def _require_free_pads(free: FreeSpace, ids: tuple[str, ...], pads: Array) -> None:
    inside = [(uav, zone) for uav, zone in zip(ids, free.inside(pads), strict=True) if zone]
    if inside:
        raise InfeasibleError(
            "Pads lie in no-fly zones, or too near to one: "
            + ", ".join(f"{uav}'s in {zone}" for uav, zone in inside[:5])
            + ".",
            cures=("other starts.positions_m", "a smaller zone or fence.margin_m"),
        )


def _require_reached(closed: Flags, found: Survey, uavs: int) -> None:
    """Raise InfeasibleError where a waypoint is walled off from the pads of all UAVs."""
    count = len(closed) - uavs
    open_ = ~closed
    _, part = connected_components(open_[:count, :count], directed=False)
    from_pads = set(part[open_[count:, :count].any(axis=0)])
    lost = [w.id for w, one in zip(found.waypoints, part, strict=True) if one not in from_pads]
    if lost:
        shown = ", ".join(map(str, lost[:8])) + (f" and {len(lost) - 8} more" * (len(lost) > 8))
        raise InfeasibleError(
            f"No way leads from the pads to waypoint{'s' * (len(lost) > 1)} {shown}: no-fly zones "
            "or the edge of fence.keep_in wall them off.",
            cures=("a gap between the zones", "a smaller fence.margin_m", "waypoints left out"),
        )


def _reach_m(scenario: Scenario) -> Array:
    """How far each UAV (A,) is heard at its greatest power."""
    radio, power_w = scenario.radio, dbm_to_w(np.array(scenario.fleet.p_max_dbm))
    return make_channel(radio).reach(power_w, float(dbm_to_w(radio.sensitivity_dbm)))


def pads_of(scenario: Scenario, found: Survey) -> Array:
    """Pad of each UAV (A, 3): on the given starting points in turn, or chosen."""
    waypoints = np.array([waypoint.position_m for waypoint in found.waypoints])
    given = np.array(scenario.starts.positions_m).reshape(-1, 2)
    given = given if found.starts_m is None else found.starts_m
    d_min_m = scenario.mission.d_min_m
    if len(given):
        start_of = np.arange(scenario.fleet.count) % len(given)
        return place_pads(given, start_of, d_min_m, found.dem.height)
    return choose_starts(
        waypoints,
        min(scenario.starts.count, len(waypoints)),
        _reach_m(scenario),
        scenario.network.k_min,
        d_min_m,
        found.dem.height,
        # The instance must not change with the seed of the search.
        np.random.default_rng(scenario.waypoints.seed),
    )


def plan_uavs(scenario: Scenario, found: Survey, pads_m: Array) -> tuple[Uav, ...]:
    """Records of a fleet on its pads (A, 3); raises InfeasibleError for too small batteries."""
    fleet = scenario.fleet
    waypoints = np.array([waypoint.position_m for waypoint in found.waypoints])
    latest = latest_arrivals_s(scenario, waypoints, pads_m)
    return tuple(
        Uav(
            id=fleet.ids[uav],
            p_max_dbm=fleet.p_max_dbm[uav],
            energy_j=fleet.energy_j[uav],
            t_max_s=float(latest[uav]),
            # As in the plan file, since times follow from them.
            speed_mps=rounded_record(limits.speed_mps),
            climb_mps=rounded_record(limits.climb_mps),
            descent_mps=rounded_record(limits.descent_mps),
            start_m=_vector(pads_m[uav]),
            endurance_s=fleet.endurance_s[uav],
            battery=battery_of(scenario, uav),
        )
        for uav, limits in enumerate(fleet_limits(scenario))
    )


def _vector(point: Array) -> Vector:
    return float(point[0]), float(point[1]), float(point[2])
