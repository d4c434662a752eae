"""Neighbours at the same distance, which no power can tell apart."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from jfto_msgs_py.types import Array
from jfto_world.compiled import allocating_kernel as kernel

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
