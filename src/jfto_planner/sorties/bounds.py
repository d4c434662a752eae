"""How many sorties it takes at least, whatever the routes."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import minimum_spanning_tree

from jfto_msgs_py.types import Array
from jfto_world.motion import ConstantSpeed, MotionLimits

# Waypoints in one place are this far apart in time, so that the tree knows the edge.
_LEAST_S = 1e-9


def least_by_time(
    waypoints_m: Array, limits: Sequence[MotionLimits], latest_s: Array, stop_s: float = 0.0
) -> int:
    """Sorties so that the fleet's time suffices for the legs between waypoints (W, 3).

    n sorties of A UAVs are n A paths, whose legs take no less than a spanning forest of as many
    trees; legs are straight, at the greatest speed of any UAV. Ways from pads count nothing.

    Parameters
    ----------
    waypoints_m
        Waypoints (W, 3), ENU metres.
    limits
        Speeds of each UAV.
    latest_s
        Latest arrival of each UAV (A,), s.
    stop_s
        Stop at each waypoint, s.

    Returns
    -------
    int
        A bound: fewer cannot do, as many need not.
    """
    fastest = MotionLimits(
        max(one.speed_mps for one in limits),
        max(one.climb_mps for one in limits),
        max(one.descent_mps for one in limits),
    )
    points = np.asarray(waypoints_m, dtype=np.float64)
    legs = ConstantSpeed().leg_matrix(points, fastest)
    legs = np.maximum(np.minimum(legs, legs.T), _LEAST_S)
    edges = np.sort(minimum_spanning_tree(csr_matrix(np.triu(legs, 1))).data)
    # Without its longest edges the tree is the least forest.
    forest_s = np.concatenate([[0.0], np.cumsum(edges)])
    stops_s, each_s = stop_s * len(points), float(np.sum(latest_s))
    for count in range(1, len(points) + 1):
        kept = max(len(edges) - (count * len(limits) - 1), 0)
        if forest_s[kept] + stops_s <= count * each_s:
            return count
    return len(points)
