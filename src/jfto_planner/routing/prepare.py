"""Turn a routing problem into the arrays on which the kernels work."""

from __future__ import annotations

import numpy as np

from jfto_msgs_py.types import Array
from jfto_planner.routing.detours import way_times
from jfto_planner.routing.kernel.prng import exponential_table
from jfto_planner.routing.kernel.tables import Tables
from jfto_planner.routing.problem import RoutingProblem

# Length of a waypoint's list of neighbours, and size of the table of random quantiles.
NEAR_LISTED = 100
QUANTILES = 4096
# The search's own time grid is fine enough for the fastest UAV to fly at most this share of the
# shortest range from one instant to the next, and has at most so many instants.
STEP_OF_REACH = 0.05
MOST_SLOTS = 2000
# What rounding may take from a plan on its way through a file, in metres and seconds.
ROUNDING_M, ROUNDING_S = 1e-4, 1e-5
# Decimals kept of distances and times, so that the last bit of a library's square root does not
# change a plan.
DECIMALS = 9
# A closed leg costs as if it were so much longer.
CLOSED_M = 20_000.0


def make_tables(problem: RoutingProblem) -> Tables:
    """Build the search's tables; `reach` and `t_max` are its own, to be tightened as it learns."""
    points = problem.nodes_m
    difference = points[:, None, :] - points[None, :, :]
    dist = np.round(np.sqrt((difference**2).sum(axis=-1)), DECIMALS)
    detours = problem.detours
    if detours is not None:
        dist = _put(dist, np.round(detours.lengths_m, DECIMALS))
    cost = dist if problem.closed_legs is None else dist + CLOSED_M * problem.closed_legs
    classes = sorted(set(problem.limits), key=lambda k: (k.speed_mps, k.climb_mps, k.descent_mps))
    leg = np.stack([problem.time_model.leg_matrix(points, limits) for limits in classes])
    share = np.zeros((len(classes), 0 if detours is None else len(detours.points_m)))
    for row, (layer, limits) in enumerate(zip(leg, classes, strict=True)):
        if detours is not None:
            times, share[row] = way_times(detours, problem.time_model, limits)  # type: ignore[arg-type]
            layer[:] = _put(layer, times)
        # What a route takes beyond its legs is spent on the first of them, which leaves a pad.
        layer[problem.waypoint_count :] += problem.time_model.overhead_s(limits)
    latest = problem.latest_arrival_s
    slots, slot_s = _grid(problem)
    speed = np.array([max(k.speed_mps, k.climb_mps, k.descent_mps) for k in problem.limits]) * 1.5
    d_min = problem.d_min_m + ROUNDING_M
    reach = problem.pair_reach_m - ROUNDING_M
    return Tables(
        dist=cost,
        leg=np.round(leg, DECIMALS),
        speed_class=np.array([classes.index(limits) for limits in problem.limits], dtype=np.int64),
        xyz=points,
        near=_nearest(dist[: problem.waypoint_count, : problem.waypoint_count]),
        t_max=latest - ROUNDING_S,
        reach=reach,
        near_sq=(d_min + (speed[:, None] + speed[None, :]) * slot_s) ** 2,
        energy_limit=np.full(problem.uav_count, np.inf),
        most=_most(problem),
        reach_exact=reach.copy(),
        k_min=problem.k_min,
        d_min=d_min,
        slot_s=slot_s,
        slots=slots,
        fine_slots=10 * problem.slot_count,
        hold_s=0.0 if problem.horizon_s is None else float(problem.horizon_s),
        power_exponent=float(problem.path_loss_exponent),
        exponential=exponential_table(QUANTILES),
        via=np.zeros((0, 0), dtype=np.int32) if detours is None else detours.index,
        via_first=np.zeros(1, dtype=np.int64) if detours is None else detours.first,
        via_xyz=np.zeros((0, 3)) if detours is None else detours.points_m,
        via_share=share,
    )


def _most(problem: RoutingProblem) -> Array:
    if problem.most_waypoints is None:
        return np.full(problem.uav_count, np.inf)
    # A copy: kernels are compiled for arrays that may be written to, and would be once more.
    return np.array(problem.most_waypoints)


def _put(values: Array, others: Array) -> Array:
    """Values with those of `others` that are a number in their place."""
    return np.where(np.isnan(others), values, others)


def _grid(problem: RoutingProblem) -> tuple[int, float]:
    longest = float(problem.latest_arrival_s.max())
    fastest = max(limits.speed_mps for limits in problem.limits)
    step_s = STEP_OF_REACH * float(problem.reach_m.min()) / fastest
    slots = min(max(problem.slot_count, int(np.ceil(longest / step_s))), MOST_SLOTS)
    return slots, longest / slots


def _nearest(dist: Array) -> np.ndarray:
    """Nearest waypoints of each, nearest first, equals in the order of their numbers."""
    order = np.argsort(dist + np.diag(np.full(len(dist), -1.0)), axis=1, kind="stable")
    return np.ascontiguousarray(order[:, 1 : NEAR_LISTED + 1].astype(np.int32))
