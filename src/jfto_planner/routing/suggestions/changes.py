"""The same problem with more link budget, or other pads; how much link budget routes lack."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from jfto_msgs_py.types import Array, Flags
from jfto_planner.routing.assess import FINER, Routes, assess, fleet_positions
from jfto_planner.routing.problem import RoutingProblem
from jfto_world.radio import pairwise_distances

PAD_SPACING = 1.05
# Pads within so many d_min of one another belong to one starting point.
SAME_START = 3.0


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


def free_pad(problem: RoutingProblem) -> Array:
    """Return the pad nearest to all others that lies beside one of them and d_min from all."""
    spacing = max(problem.d_min_m * PAD_SPACING, 1.0)
    angle = np.arange(12) * (np.pi / 6)
    ring = np.column_stack([np.cos(angle), np.sin(angle), np.zeros(12)]) * spacing
    spots = (problem.starts_m[:, None, :] + ring).reshape(-1, 3)
    gaps = np.linalg.norm(spots[:, None, :] - problem.starts_m, axis=2)
    cost = np.where(gaps.min(axis=1) >= problem.d_min_m, gaps.sum(axis=1), np.inf)
    return spots[int(np.argmin(cost))]


def with_twin_pad(problem: RoutingProblem, pad: Array) -> Flags | None:
    """Closed legs of a fleet with one more pad, which are those of the pad beside it."""
    if problem.closed_legs is None:
        return None
    beside = int(np.linalg.norm(problem.starts_m - pad, axis=1).argmin())
    nodes = [*range(len(problem.closed_legs)), problem.waypoint_count + beside]
    return problem.closed_legs[np.ix_(nodes, nodes)]


def drawn_together(problem: RoutingProblem, centre: Array, share: float) -> Array:
    """Pads with the distances of their starting points from a centre scaled by `share`.

    Pads within a few d_min of one another belong to one starting point and move as one.
    """
    gaps = pairwise_distances(problem.starts_m * [1.0, 1.0, 0.0])
    group = (gaps <= SAME_START * problem.d_min_m).argmax(axis=1)
    anchor = np.stack([problem.starts_m[group == group[a]].mean(axis=0) for a in range(len(group))])
    pads = problem.starts_m.copy()
    pads[:, :2] -= (anchor[:, :2] - centre[:2]) * (1.0 - share)
    return pads
