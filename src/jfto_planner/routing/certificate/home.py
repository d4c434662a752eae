"""The ways home of a plan, flown anew and held against its rules.

Shares no code with the planning of them.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from jfto_msgs_py.errors import PlanError
from jfto_msgs_py.records.certificate import Violation, WayHomeCheck
from jfto_msgs_py.records.plan import Plan, Uav
from jfto_msgs_py.records.way_home import WayHome
from jfto_msgs_py.types import Array
from jfto_planner.routing.certificate.between import chord_distance
from jfto_planner.routing.certificate.ground import PAD_M, GroundRule
from jfto_planner.routing.certificate.ground import TOLERANCE_M as GROUND_M
from jfto_planner.routing.certificate.routes import TOLERANCE_M, TOLERANCE_S
from jfto_world.motion import MotionLimits
from jfto_world.motion.landing import landing_places, landing_s
from jfto_world.motion.way_home import home_model

# Chords this short leave an arc by a hundredth of a metre at 10 m/s².
STEP_S = 0.1
# Links are looked at so often.
LINKS_S = 1.0


def home_times_s(plan: Plan, step_s: float) -> Array:
    """Instants from the horizon until all are down, (T,)."""
    end_s = max(home.landed_s for home in plan.homes)
    return plan.slots.horizon_s + np.arange(
        0.0, max(end_s - plan.slots.horizon_s, 0.0) + step_s, step_s
    )


def home_places_m(plan: Plan, times_s: Array) -> Array:
    """Where everybody is at times from the horizon on, (T, A, 3); raises PlanError, InputError."""
    return np.stack([_fly(plan, a, times_s)[1] for a in range(len(plan.uavs))], axis=1)


def check_home(
    plan: Plan, ground: GroundRule | None
) -> tuple[list[Violation], WayHomeCheck | None]:
    """Violations of the ways home, and their least distances; nothing for a plan without.

    The shares of time with links are left at 0, for who knows the radio. Raises PlanError where
    there is not one way per UAV.
    """
    if not plan.homes:
        return [], None
    if len(plan.homes) != len(plan.uavs):
        raise PlanError(
            f"plan: {len(plan.homes)} ways home for {len(plan.uavs)} UAVs, must be one each."
        )
    times = home_times_s(plan, STEP_S)
    flown = [_fly(plan, a, times) for a in range(len(plan.uavs))]
    found = []
    for a, (uav, home) in enumerate(zip(plan.uavs, plan.homes, strict=True)):
        found += _check_records(plan, a, home, flown[a][0])
        if uav.endurance_s and home.landed_s > uav.endurance_s:
            message = (
                f"{uav.id} stands at its pad after {home.landed_s:.0f} s, its battery lasts "
                f"{uav.endurance_s:g} s"
            )
            found.append(_violation(uav, home.landed_s, uav.endurance_s, message, "endurance"))
    if ground is not None:
        found += _check_ground(plan, [places for _, places in flown], ground, times)
    close, nearest_m = _check_apart(plan, np.stack([places for _, places in flown], 1), times)
    landed_s = max(home.landed_s for home in plan.homes)
    return [*found, *close], WayHomeCheck(landed_s, nearest_m, 0.0, 0.0)


def _fly(plan: Plan, a: int, times_s: Array) -> tuple[Array, Array]:
    """When the points of a way home are reached (K,), from when it begins; where it is (T, 3)."""
    uav, home = plan.uavs[a], plan.homes[a]
    line, leave_s = home.line_m, home.reached_s[0]
    if len(line) == 1:
        reached, places = np.zeros(1), np.tile(line, (len(times_s), 1))
    else:
        model = home_model(plan.time_model, plan.time_parameters)
        limits = MotionLimits(uav.speed_mps, uav.climb_mps, uav.descent_mps)
        reached = model.arrivals(line, limits)
        places = model.positions(line, limits, np.maximum(times_s - leave_s, 0.0))
    hover_s = home.reached_s[-1]
    landing = times_s > hover_s
    places[landing] = landing_places(line[-1], uav.start_m[2], times_s[landing] - hover_s)
    return reached, places


def _check_records(plan: Plan, a: int, home: WayHome, reached_s: Array) -> list[Violation]:
    """Where and when it begins and ends against the route, its times against its legs."""
    uav, line, route = plan.uavs[a], home.line_m, plan.routes[a]
    counted_s = plan.slots.horizon_s if plan.trajectories else route.end_s
    begin = plan.line_m(a)[-1] if route.waypoint_ids else plan.positions_m[a, -1]
    asked = (
        ("begins off its last waypoint by", "m", np.linalg.norm(line[0] - begin), TOLERANCE_M),
        (
            "ends off its pad by",
            "m",
            np.hypot(*(line[-1] - np.array(uav.start_m))[:2]),
            TOLERANCE_M,
        ),
        (
            "begins before all are done by",
            "s",
            max(plan.slots.horizon_s, route.end_s) - home.leave_s,
            TOLERANCE_S,
        ),
        (
            "is timed off its legs by",
            "s",
            np.abs(np.array(home.reached_s) - home.leave_s - reached_s).max(),
            TOLERANCE_S,
        ),
        (
            "is down sooner than it can land by",
            "s",
            home.reached_s[-1] + landing_s(line[-1, 2] - uav.start_m[2]) - home.landed_s,
            TOLERANCE_S,
        ),
        (
            "does not hold as long as it says, by",
            "s",
            abs(counted_s + home.hold_s - home.leave_s) if route.arrival_s else 0.0,
            TOLERANCE_S,
        ),
    )
    return [
        _violation(uav, float(off), limit, f"{uav.id}'s way home {what} {off:.3f} {unit}")
        for what, unit, off, limit in asked
        if not off <= limit
    ]


def _check_ground(
    plan: Plan, flown: list[Array], rule: GroundRule, times_s: Array
) -> list[Violation]:
    """UAVs too low away from where they begin and from their pads, one violation each."""
    found = []
    for uav, home, places in zip(plan.uavs, plan.homes, flown, strict=True):
        line = home.line_m
        away = np.hypot(*(places[:, :2] - np.array(uav.start_m)[:2]).T) > PAD_M
        away &= np.hypot(*(places[:, :2] - line[0, :2]).T) > PAD_M
        if not away.any():
            continue
        above = places[away, 2] - rule.height(places[away, 0], places[away, 1])
        worst = int(np.argmin(above))
        if above[worst] < rule.clearance_m - GROUND_M:
            at_s = float(times_s[away][worst])
            message = (
                f"{uav.id} is {above[worst]:.1f} m above the ground at {at_s:.1f} s on its way "
                f"home, {rule.clearance_m:g} m are wanted"
            )
            one = _violation(uav, float(above[worst]), rule.clearance_m, message)
            found.append(replace(one, time_s=at_s))
    return found


def _check_apart(plan: Plan, places_m: Array, times_s: Array) -> tuple[list[Violation], float]:
    """Pairs nearer than d_min at any time, one violation each, and the least distance of all."""
    first, second = np.triu_indices(len(plan.uavs), 1)
    if not len(first) or len(places_m) < 2:
        return [], np.nan
    nearest = chord_distance(places_m[:, first] - places_m[:, second])
    found = []
    worst = nearest.min(axis=0)
    for pair in np.flatnonzero(worst < plan.d_min_m - TOLERANCE_M):
        names = f"{plan.uavs[first[pair]].id}+{plan.uavs[second[pair]].id}"
        at_s, gap = float(times_s[int(nearest[:, pair].argmin())]), float(worst[pair])
        message = (
            f"{names} are {gap:.2f} m apart at {at_s:.1f} s on their way home, d_min is "
            f"{plan.d_min_m:g} m"
        )
        found.append(Violation("home", names, None, at_s, gap, plan.d_min_m, message))
    return found, float(worst.min())


def _violation(uav: Uav, value: float, limit: float, message: str, kind: str = "home") -> Violation:
    return Violation(kind, uav.id, None, None, value, limit, message)
