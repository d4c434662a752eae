"""Who still hears whom, also when one UAV drops out."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from jfto_msgs_py.errors import InputError
from jfto_msgs_py.types import Flags
from jfto_world.compiled import allocating_kernel as kernel


def connectivity_rate(adjacency: Flags, first_slot: int, on_air: Flags | None = None) -> float:
    """ξ: mean share of the survivors that stay in one component when one UAV is lost.

    `adjacency` is (N + 1, A, A), symmetric; each UAV in turn is gone from n = `first_slot` (n_DC)
    to N, powers staying as planned. `on_air` (N + 1, A) marks UAVs with energy left; one off the
    air counts as lost too. ξ = Σ_a Σ_n AC_a(n)/(A - 1) / (A (N - n_DC + 1)), AC being the size of
    the largest component. Raises InputError for one UAV or a slot beyond the plan.
    """
    slots, uavs = adjacency.shape[:2]
    if not 0 <= first_slot < slots:
        raise InputError(f"first_slot is {first_slot}, must be from 0 to {slots - 1}.")
    if uavs < 2:
        raise InputError("connectivity_rate needs at least 2 UAVs.")
    alive = np.ones((slots, uavs), dtype=np.bool_) if on_air is None else on_air
    survivors = np.repeat(alive[first_slot:, None, :], uavs, axis=1)
    survivors[:, np.arange(uavs), np.arange(uavs)] = False
    links = np.ascontiguousarray(adjacency[first_slot:])
    sizes = np.stack([largest_component(links, survivors[:, a]) for a in range(uavs)])
    return float(sizes.mean() / (uavs - 1))


def largest_component(adjacency: Flags, present: Flags) -> NDArray[np.int64]:
    """Size of the largest component among the UAVs present, (M,); 0 where nobody is.

    `adjacency` is (M, A, A), `present` (M, A).
    """
    label = components(adjacency, present)
    counts = (label[:, :, None] == np.arange(label.shape[1])).sum(axis=1)
    return counts.max(axis=1, initial=0)


@kernel
def components(adjacency: Flags, present: Flags) -> NDArray[np.int64]:
    """Component of each UAV present, numbered from 0 in order of lowest index, -1 if absent.

    `adjacency` is (M, A, A), symmetric, `present` and the result (M, A).
    """
    slots, uavs = present.shape
    label = np.full((slots, uavs), -1, dtype=np.int64)
    stack = np.empty(uavs, dtype=np.int64)
    for m in range(slots):
        count = 0
        for seed in range(uavs):
            if label[m, seed] >= 0 or not present[m, seed]:
                continue
            label[m, seed] = count
            stack[0] = seed
            depth = 1
            while depth > 0:
                depth -= 1
                a = stack[depth]
                for b in range(uavs):
                    if adjacency[m, a, b] and present[m, b] and label[m, b] < 0:
                        label[m, b] = count
                        stack[depth] = b
                        depth += 1
            count += 1
    return label
