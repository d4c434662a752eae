"""Transmit-power intervals that keep a given set of links, down to what powers can tell apart."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from jfto_msgs_py.types import Array, Flags
from jfto_topology.algorithms.required_power import checked_caps, required_powers
from jfto_world.compiled import allocating_kernel as kernel
from jfto_world.radio import Channel

# Powers closer than this, relatively, belong to one ring: an interval between them would be too
# narrow for any radio, and rounding alone separates UAVs that hover on a regular grid.
RING_WIDTH = 1e-9


@kernel
def ring_powers(required_w: Array) -> Array:
    """Power that takes in b together with all that a cannot tell apart from b by power.

    `required_w` is (M, A, A); so is the result: the greatest entry of the run of entries of a's
    row around b whose neighbours lie within RING_WIDTH of each other. Not symmetric.
    """
    slots, uavs, _ = required_w.shape
    ring_w = required_w.copy()
    order = np.empty(uavs, dtype=np.int64)
    for m in range(slots):
        for a in range(uavs):
            row = required_w[m, a]
            _sort(row, order)
            for rank in range(uavs - 2, -1, -1):
                here, beyond = order[rank], order[rank + 1]
                if row[beyond] <= row[here] * (1.0 + RING_WIDTH):
                    ring_w[m, a, here] = ring_w[m, a, beyond]
    return ring_w


@kernel
def _sort(row: Array, order: NDArray) -> None:
    """Put the indices of a row into `order` by rising value; insertion suits rows this short."""
    for index in range(row.shape[0]):
        place = index
        while place > 0 and row[order[place - 1]] > row[index]:
            order[place] = order[place - 1]
            place -= 1
        order[place] = index


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


def kept_intervals(
    adjacency: Flags, positions_m: Array, channel: Channel, p_max_w: Array, sensitivity_w: float
) -> tuple[Array, Array]:
    """Least and greatest safe powers (M, A) that keep the links of `adjacency` (M, A, A).

    As C-TOP does for its own links, so that a baseline's topology can be given the exact power
    allocation too. Links that are out of reach at P_a,max are left out.
    """
    required_w = required_powers(positions_m, channel, p_max_w, sensitivity_w)
    active = np.ascontiguousarray(adjacency & np.isfinite(required_w))
    caps_w = checked_caps(p_max_w, required_w.shape[1])
    low, _, upper, _ = power_intervals(required_w, ring_powers(required_w), active, caps_w)
    return low, upper
