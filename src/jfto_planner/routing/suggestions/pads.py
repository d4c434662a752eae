"""Other pads for a fleet."""

from __future__ import annotations

import numpy as np

from jfto_msgs_py.types import Array, Flags
from jfto_planner.routing.problem import RoutingProblem
from jfto_world.radio import pairwise_distances

PAD_SPACING = 1.05
# Pads within so many d_min of one another belong to one starting point.
SAME_START = 3.0


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
