"""What a plan's routes say, recomputed, against what its other records say."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass

import numpy as np

from jfto_msgs_py.errors import PlanError
from jfto_msgs_py.records.certificate import Violation
from jfto_msgs_py.records.plan import Plan
from jfto_msgs_py.types import Array
from jfto_planner.routing.certificate.curves import check_curves, curves_of
from jfto_world.motion import MotionLimits, time_model_named
from jfto_world.motion.lines import along

# Plan files round to micrometres and microseconds, and sums of them differ by more.
TOLERANCE_M = 1e-3
TOLERANCE_S = 1e-3
# The time model whose flights are written out in the plan.
CURVES = "bezier"


@dataclass(frozen=True)
class Flown:
    """Routes as flown by the plan's time model.

    `arrivals_s[a]` starts with the pad's 0 s; `positions_m` is (finer N + 1, A, 3). `faults` are
    those of the trajectories themselves.
    """

    arrivals_s: tuple[Array, ...]
    length_m: tuple[float, ...]
    positions_m: Array
    faults: tuple[Violation, ...] = ()


def fly(plan: Plan, finer: int) -> Flown:
    """Recompute arrivals, lengths and positions from the routes.

    Unknown waypoint ids are flown past; check_routes reports them.

    Parameters
    ----------
    plan
        A plan.
    finer
        Instants per slot.

    Returns
    -------
    Flown
        What the routes come to.

    Raises
    ------
    PlanError
        The plan cannot be flown as it stands.
    InputError
        Its time model is unknown.
    """
    if plan.trajectories and plan.time_model != CURVES:
        raise PlanError(
            f"plan: it holds trajectories, but its time_model is {plan.time_model!r}, which flies "
            f"none. Write the plan anew with jfto plan."
        )
    curves = curves_of(plan) if plan.time_model == CURVES else None
    model = None if curves else time_model_named(plan.time_model, plan.time_parameters)
    where = {waypoint.id: waypoint.position_m for waypoint in plan.waypoints}
    times = np.arange(finer * plan.slots.count + 1, dtype=np.float64) * (
        plan.slots.duration_s / finer
    )
    lines, arrivals, lengths, positions = [], [], [], []
    for a, (uav, route) in enumerate(zip(plan.uavs, plan.routes, strict=True)):
        limits = MotionLimits(uav.speed_mps, uav.climb_mps, uav.descent_mps)
        known = [where[number] for number in route.waypoint_ids if number in where]
        points = np.array([uav.start_m, *known], dtype=np.float64)
        lines.append(points)
        if curves:
            arrivals.append(np.concatenate([[0.0], curves[a].waypoint_s[1:]]))
            positions.append(curves[a].at(times))
        elif model is not None:
            flight = along(model, route.lines)
            arrivals.append(flight.arrivals(points, limits))
            positions.append(flight.positions(points, limits, times))
        lengths.append(float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum()))
    faults = tuple(check_curves(plan, curves, lines)) if curves else ()
    return Flown(tuple(arrivals), tuple(lengths), np.stack(positions, axis=1), faults)


def check_routes(plan: Plan, flown: Flown) -> list[Violation]:
    """Waypoints not visited exactly once, and records that contradict the routes."""
    found = [*_check_visits(plan), *flown.faults]
    finer = (len(flown.positions_m) - 1) // plan.slots.count
    apart = np.linalg.norm(np.moveaxis(plan.positions_m, 0, 1) - flown.positions_m[::finer], axis=2)
    for a, (uav, route) in enumerate(zip(plan.uavs, plan.routes, strict=True)):
        slot = int(np.argmax(apart[:, a]))
        gap = float(apart[slot, a])
        if gap > TOLERANCE_M:
            time = slot * plan.slots.duration_s
            message = f"{uav.id} is {gap:.3f} m from where its route puts it in slot {slot}"
            found.append(Violation("route", uav.id, slot, time, gap, TOLERANCE_M, message))
        stated = np.array(route.arrival_s)
        expected = flown.arrivals_s[a][1:]
        if len(stated) == len(expected) and len(stated):
            k = int(np.argmax(np.abs(stated - expected)))
            late = float(abs(stated[k] - expected[k]))
            if not late <= TOLERANCE_S:
                message = (
                    f"{uav.id} is said to reach waypoint {route.waypoint_ids[k]} at "
                    f"{stated[k]:.3f} s, its route takes {expected[k]:.3f} s"
                )
                found.append(Violation("route", uav.id, None, None, late, TOLERANCE_S, message))
        longer = abs(route.length_m - flown.length_m[a])
        if not longer <= TOLERANCE_M:
            message = (
                f"{uav.id}'s route is said to be {route.length_m:.3f} m long and measures "
                f"{flown.length_m[a]:.3f} m"
            )
            found.append(Violation("route", uav.id, None, None, longer, TOLERANCE_M, message))
    return found


def _check_visits(plan: Plan) -> list[Violation]:
    visits = Counter(number for route in plan.routes for number in route.waypoint_ids)
    known = Counter(waypoint.id for waypoint in plan.waypoints)
    found = []
    for number in sorted(known | visits):
        if known[number] > 1:
            message = f"{known[number]} waypoints have the id {number}"
        elif not known[number]:
            message = f"waypoint {number} is on a route and not in the plan"
        elif visits[number] != 1:
            message = f"waypoint {number} is visited {visits[number]} times"
        else:
            continue
        value = float(visits[number])
        found.append(Violation("visit", "", None, None, value, 1.0, message))
    return found
