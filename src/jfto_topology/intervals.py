"""Transmit-power intervals that keep a given set of links."""

from __future__ import annotations

import numpy as np

from jfto_msgs_py.types import Array, Flags
from jfto_topology.rings import RING_WIDTH
from jfto_world.compiled import allocating_kernel as kernel


@kernel
def power_intervals(
    required_w: Array, ring_w: Array, active: Flags, p_max_w: Array
) -> tuple[Array, Array, Array, Flags]:
    """P̃min, P̃max, the greatest safe power, and the mutual reach they make.

    `required_w`, `ring_w` and `active` are (M, A, A), `p_max_w` (A,). P̃min serves the farthest
    active neighbour (0 without one); P̃max is the power of the next candidate beyond, exclusive,
    or P_a,max, inclusive, where there is none (eq. Pmax1). The third result is always inclusive.
    Every choice of powers inside the intervals makes the same mutual reach (M, A, A).
    """
    slots, uavs, _ = required_w.shape
    low = np.zeros((slots, uavs))
    bound = np.empty((slots, uavs))
    upper = np.empty((slots, uavs))
    reach = np.zeros((slots, uavs, uavs), dtype=np.bool_)
    for m in range(slots):
        for a in range(uavs):
            for b in range(uavs):
                if active[m, a, b] and ring_w[m, a, b] > low[m, a]:
                    low[m, a] = ring_w[m, a, b]
            following = np.inf
            for b in range(uavs):
                if low[m, a] < required_w[m, a, b] < following:
                    following = required_w[m, a, b]
            bound[m, a] = min(following, p_max_w[a])
            # Rings are RING_WIDTH apart, so half of it stays clear of both sides.
            below = following * (1.0 - RING_WIDTH / 2)
            upper[m, a] = min(below, p_max_w[a])
        for a in range(uavs):
            for b in range(uavs):
                reach[m, a, b] = required_w[m, a, b] <= min(low[m, a], low[m, b])
    return low, bound, upper, reach
