"""The link budget that routes lack."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from jfto_msgs_py.types import Array
from jfto_planner.routing.assess import FINER, Routes, assess, fleet_positions
from jfto_planner.routing.problem import RoutingProblem
from jfto_world.radio import pairwise_distances


def missing_gain_db(problem: RoutingProblem, routes: Routes) -> float:
    """Least extra link budget in dB at which routes keep neighbours, connectivity and energy.

    At a gain of g the range grows by g^(1/exponent) and every needed power falls by g.
    """
    exact = assess(problem, routes)
    distance = pairwise_distances(fleet_positions(problem, routes, instants_s(problem, routes)))
    ratio = distance / problem.pair_reach_m
    uavs = problem.uav_count
    ratio[:, np.arange(uavs), np.arange(uavs)] = 0.0
    worst = float(np.sort(ratio, axis=2)[:, :, problem.k_min].max())
    worst = max(worst, float(_bottleneck(ratio).max()))
    needed_db = 10.0 * problem.path_loss_exponent * np.log10(max(worst, 1.0))
    if exact.energy_j and problem.energy_j is not None:
        over = float((np.array(exact.energy_j) / problem.energy_j).max())
        needed_db = max(needed_db, 10.0 * np.log10(max(over, 1.0)))
    return float(needed_db)


def instants_s(problem: RoutingProblem, routes: Routes) -> Array:
    """The instants at which routes are checked, (10 N + 1,)."""
    count = problem.slot_count * FINER
    horizon_s = problem.horizon_s
    if horizon_s is None:
        horizon_s = assess(problem, routes).makespan_s
    return np.arange(count + 1, dtype=np.float64) * (horizon_s / count)


def with_gain(problem: RoutingProblem, gain_db: float) -> RoutingProblem:
    """Return the problem with a stronger link budget."""
    ratio = 10.0 ** (gain_db / 10.0)
    energy = None if problem.energy_j is None else problem.energy_j * ratio
    reach = problem.reach_m * ratio ** (1.0 / problem.path_loss_exponent)
    return replace(problem, reach_m=reach, energy_j=energy)


def _bottleneck(ratio: Array) -> Array:
    """Longest edge of the minimum spanning tree of each graph (T, A, A), by Prim's algorithm."""
    rows = np.arange(len(ratio))
    inside = np.zeros(ratio.shape[:2], dtype=bool)
    inside[:, 0] = True
    best = ratio[:, 0].copy()
    longest = np.zeros(len(ratio))
    for _ in range(ratio.shape[1] - 1):
        best_outside = np.where(inside, np.inf, best)
        joined = best_outside.argmin(axis=1)
        longest = np.maximum(longest, best_outside[rows, joined])
        inside[rows, joined] = True
        best = np.minimum(best, ratio[rows, joined])
    return longest
