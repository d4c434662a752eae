"""A cheap stand-in for the energy that the least powers of the topology cost.

Compiled for the search, and in array code for what it finds.
"""

from __future__ import annotations

import numpy as np

from jfto_msgs_py.types import Array
from jfto_planner.routing.kernel.radio import fill_ratios, kth_nearest
from jfto_planner.routing.kernel.tables import State, Tables, Work
from jfto_world.compiled import inner
from jfto_world.radio import pairwise_distances


@inner
def energy_spent(
    tables: Tables, cur: State, cand: State, work: Work, last: int, horizon_s: float
) -> None:
    """Set work.spent to the proxy of every UAV.

    The proxy is the time integral of (distance / 1 km)^exponent to the farthest of a UAV's k_min
    nearest others and of those that count it among theirs. It is a stranger to transmit powers:
    the search learns its exchange rate to joules from the exact energy floor.
    """
    uavs = cand.size.shape[0]
    work.spent[:] = 0.0
    for slot in range(1, last + 1):
        fill_ratios(tables, cur, cand, work, slot)
        for a in range(uavs):
            for b in range(uavs):
                work.ratio[a, b] *= tables.reach[a, b] * 1e-3
            work.need[a] = 0.0
        for a in range(uavs):
            farthest = kth_nearest(work, a, max(tables.k_min, 1))
            work.need[a] = max(work.need[a], farthest)
            for b in range(uavs):
                if b != a and work.ratio[a, b] <= farthest:
                    work.need[b] = max(work.need[b], work.ratio[a, b])
        share = tables.slot_s
        if slot == last:
            share = max(0.0, horizon_s - (last - 1) * tables.slot_s)
        for a in range(uavs):
            work.spent[a] += share * work.need[a] ** tables.power_exponent


@inner
def energy_excess(tables: Tables, work: Work) -> float:
    """Summed relative excess of work.spent over the limits."""
    excess = 0.0
    for a in range(work.spent.shape[0]):
        excess += max(0.0, work.spent[a] / tables.energy_limit[a] - 1.0)
    return excess


def energy_proxy(positions_m: Array, slot_s: float, k_min: int, exponent: float) -> Array:
    """Time integral of (distance / 1 km)^exponent to the farthest UAV that one must reach, (A,).

    Those are a UAV's k_min nearest (at least one) and all that count it among theirs.
    `positions_m` is (N + 1, A, 3).
    """
    uavs = positions_m.shape[1]
    if uavs == 1:
        return np.zeros(1)
    distance = pairwise_distances(positions_m) * 1e-3
    distance[:, np.arange(uavs), np.arange(uavs)] = np.inf
    kth = np.sort(distance, axis=-1)[:, :, max(k_min, 1) - 1]
    mutual = distance <= np.maximum(kth[:, :, None], kth[:, None, :])
    need = np.where(mutual, distance, 0.0).max(axis=-1)
    return (need[1:] ** exponent).sum(axis=0) * slot_s
