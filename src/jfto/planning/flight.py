"""How a scenario's routes are flown: its time model, for the search and for the plan."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from jfto.planning.speeds import photo_cap_mps
from jfto_msgs_py.plan_file import rounded_record
from jfto_msgs_py.records.plan import Plan
from jfto_msgs_py.scenario import Scenario
from jfto_msgs_py.types import Array, GroundHeight
from jfto_planner.routing import Estimated, RoutingProblem
from jfto_planner.routing.assess import Routes, is_connected, route_points
from jfto_planner.smoothing import (
    Clearance,
    CurveLimits,
    CurveRules,
    SmoothFlight,
    SmoothingSettings,
    Trajectory,
    kept_apart,
    smooth_fleet,
)
from jfto_world.mission.steps import mission_items
from jfto_world.motion import TimeModel, time_model_named
from jfto_world.motion.battery import airborne, drain_of
from jfto_world.radio import degrees, pairwise_distances

if TYPE_CHECKING:
    from jfto_world.site.free_space import FreeSpace

# What a rule that was broken is tightened by before the next search, beyond what was missing.
SPARE_S, SPARE_M = 1.0, 1.0
SHORTER_REACH, LESS_ENERGY = 0.98, 0.98


# Parameters of a plan's time model, and the keys of scenario part trajectory that they come from.
ARDUCOPTER_KEYS = {
    "hold_s": "hold_s",
    "takeoff_m": "takeoff_m",
    "accel_mps2": "wpnav_accel_mps2",
    "accel_z_mps2": "wpnav_accel_z_mps2",
    "jerk_mps3": "wpnav_jerk_mps3",
    "radius_m": "wpnav_radius_m",
    "angle_max_deg": "angle_max_deg",
}
CURVE_KEYS = {
    "accel_mps2": "curve_accel_mps2",
    "accel_z_mps2": "curve_accel_z_mps2",
    "jerk_mps3": "curve_jerk_mps3",
    "tilt_deg": "curve_tilt_deg",
}


@dataclass(frozen=True)
class Flight:
    """`time_model` is how the routes are flown; `name` and `parameters` are for the plan.

    `exact` says that the plan's times are those of the search, `estimated` that leg times are only
    an estimate. `rules` and `limits` of the curves
    are there in guided flight only.
    """

    name: str
    parameters: Mapping[str, float]
    time_model: TimeModel
    exact: bool = True
    estimated: bool = True
    rules: CurveRules | None = None
    curve: Mapping[str, float] | None = None

    def model(self, corrected: TimeModel | None = None) -> TimeModel:
        """What the search goes by: the time model, or it with leg estimates corrected."""
        model = corrected or self.time_model
        return model if self.exact else Estimated(model)

    def trajectories(
        self,
        problem: RoutingProblem,
        routes: Routes,
        names: tuple[str, ...],
        ground_height: GroundHeight,
    ) -> tuple[Trajectory, ...]:
        """Curves of routes, apart from one another where that can be; empty unless guided.

        Raises InfeasibleError where a route cannot be flown above the ground.
        """
        if self.rules is None or self.curve is None:
            return ()
        smooth = smooth_fleet(
            names,
            tuple(route_points(problem, a, route) for a, route in enumerate(routes)),
            tuple(CurveLimits.of(limits, **self.curve) for limits in problem.limits),
            ground_height,
            self.rules,
        )
        return kept_apart(smooth, problem.d_min_m, lambda places: _together(problem, places))


def flight_of(scenario: Scenario) -> Flight:
    """Time model of a scenario's trajectory part."""
    wanted = scenario.trajectory
    if wanted.mode == "straight":
        return Flight("constant_speed", {}, time_model_named("constant_speed"), estimated=False)
    if wanted.mode == "waypoints":
        parameters = rounded_record(
            {name: getattr(wanted, key) for name, key in ARDUCOPTER_KEYS.items()}
        )
        # Loaded here: its compiler takes a second, which constant speed need not pay.
        from jfto_world.motion.arducopter import ArduCopter

        model = ArduCopter.of_parameters(parameters)
        return Flight("arducopter", model.parameters(), model)
    curve = {name: getattr(wanted, key) for name, key in CURVE_KEYS.items()}
    settings = SmoothingSettings(corridor_m=wanted.corridor_m)
    cap = photo_cap_mps(scenario)
    smooth = SmoothFlight(
        tuple(curve.items()), cap, wanted.hold_s, climb_m=wanted.clearance_m, settings=settings
    )
    rules = CurveRules(Clearance(wanted.clearance_m), wanted.hold_s, cap, settings)
    return Flight("bezier", curve, smooth, exact=False, rules=rules, curve=curve)


def keeping_out(flight: Flight, free: FreeSpace | None) -> Flight:
    """The same flight, its curves outside of no-fly zones."""
    if flight.rules is None or free is None:
        return flight
    return replace(flight, rules=replace(flight.rules, keep_out=free.blocked))


def expected_s(problem: RoutingProblem, routes: Routes) -> Array:
    """When each UAV is done by the estimate that the search goes by, (A,)."""
    estimate = Estimated(problem.time_model)
    return np.array(
        [
            estimate.arrivals(route_points(problem, a, route), limits)[-1]
            for a, (route, limits) in enumerate(zip(routes, problem.limits, strict=True))
        ]
    )


def ends_s(plan: Plan) -> Array:
    """When each UAV reaches its last waypoint, (A,); 0 where it has none."""
    return np.array([max(route.arrival_s, default=0.0) for route in plan.routes])


def tightened(problem: RoutingProblem, plan: Plan) -> RoutingProblem:
    """The problem with limits drawn in where the certified `plan` broke them.

    Of the ways home only their duration can be drawn in.
    """
    assert plan.certificate is not None
    broken = {violation.kind for violation in plan.certificate.violations}
    late_s = np.maximum(ends_s(plan) - np.array([uav.t_max_s for uav in plan.uavs]), 0.0)
    late_s = np.maximum(late_s, _too_long_s(plan, problem))
    changes: dict[str, object] = {}
    if late_s.any():
        changes["t_max_s"] = problem.t_max_s - np.where(late_s > 0, late_s + SPARE_S, 0.0)
    if broken & {"neighbours", "connected"}:
        changes["reach_m"] = problem.reach_m * SHORTER_REACH
    if "separation" in broken:
        missing = plan.d_min_m - plan.certificate.worst_separation_m
        changes["d_min_m"] = min(
            problem.d_min_m + missing + SPARE_M, least_distance_m(problem.starts_m)
        )
    if "items" in broken:
        changes["most_waypoints"] = _fewer(plan, problem)
    if "energy" in broken and problem.energy_j is not None:
        changes["energy_j"] = problem.energy_j * LESS_ENERGY
    return replace(problem, **changes)  # type: ignore[arg-type]


def _fewer(plan: Plan, problem: RoutingProblem) -> Array:
    """How many waypoints each UAV (A,) may have, less what made its mission too long."""
    most = np.full(len(plan.uavs), float(len(plan.waypoints)))
    if problem.most_waypoints is not None:
        most = problem.most_waypoints.copy()
    for a, route in enumerate(plan.routes):
        items = mission_items(plan, a)
        if items > plan.mission_items:
            each = items / len(route.waypoint_ids)
            over = math.ceil((items - plan.mission_items) / each)
            most[a] = max(min(most[a], len(route.waypoint_ids)) - over, 1.0)
    return most


def _too_long_s(plan: Plan, problem: RoutingProblem) -> Array:
    """By how much sooner each UAV (A,) must be done so that batteries bring all of them home.

    Nobody leaves before all are done, so that one short battery draws everybody in.
    """
    over_s = [
        home.landed_s - uav.endurance_s
        for uav, home in zip(plan.uavs, plan.homes, strict=bool(plan.homes))
        if uav.endurance_s
    ]
    if plan.homes:
        drains = ((drain_of(plan, a), airborne(plan, a)) for a in range(len(plan.uavs)))
        over_s += [-drain.left_s(flown) for drain, flown in drains if drain is not None]
    worst_s = max(over_s, default=0.0)
    done_s = float(ends_s(plan).max()) - worst_s
    # A horizon that is given does not move, and nobody is done before lift-off.
    if worst_s <= 0 or problem.horizon_s is not None or done_s <= 2 * SPARE_S:
        return np.zeros(len(plan.uavs))
    return np.asarray(np.maximum(problem.t_max_s - done_s, 0.0))


def least_distance_m(places_m: Array) -> float:
    """Of any two places (A, 3); infinite for one."""
    apart = pairwise_distances(places_m[None])[0]
    return float(apart[np.triu_indices(len(places_m), 1)].min(initial=np.inf))


def _together(problem: RoutingProblem, positions_m: Array) -> bool:
    """Whether everybody at (K, A, 3) has its neighbours, and the fleet is one."""
    linked = pairwise_distances(positions_m) <= problem.pair_reach_m
    linked[:, np.arange(problem.uav_count), np.arange(problem.uav_count)] = False
    return bool((degrees(linked) >= problem.k_min).all() and is_connected(linked).all())
