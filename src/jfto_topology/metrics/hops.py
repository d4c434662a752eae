"""How many links a message passes over."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from jfto_world.compiled import allocating_kernel as kernel


def average_hops(adjacency: NDArray[np.bool_]) -> float:
    """Mean shortest-path length over ordered pairs and slots; inf if any slot is disconnected.

    `adjacency` is (M, A, A), symmetric. 0 for a single UAV.
    """
    hops = hop_counts(np.ascontiguousarray(adjacency))
    pairs = hops.shape[0] * hops.shape[1] * (hops.shape[1] - 1)
    if not pairs:
        return 0.0
    # The diagonal is 0, and -1 marks a pair without a path.
    return float("inf") if (hops < 0).any() else float(hops.sum() / pairs)


@kernel
def hop_counts(adjacency: NDArray[np.bool_]) -> NDArray[np.int64]:
    """Links on the shortest path between all pairs, (M, A, A); -1 where there is none."""
    slots, uavs, _ = adjacency.shape
    hops = np.full((slots, uavs, uavs), -1, dtype=np.int64)
    queue = np.empty(uavs, dtype=np.int64)
    for m in range(slots):
        for origin in range(uavs):
            hops[m, origin, origin] = 0
            queue[0] = origin
            head, tail = 0, 1
            while head < tail:
                a = queue[head]
                head += 1
                for b in range(uavs):
                    if adjacency[m, a, b] and hops[m, origin, b] < 0:
                        hops[m, origin, b] = hops[m, origin, a] + 1
                        queue[tail] = b
                        tail += 1
    return hops
