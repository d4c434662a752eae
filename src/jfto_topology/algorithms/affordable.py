"""A topology that every UAV can pay for, as demanding as it can be."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import fields

import numpy as np
from numpy.typing import NDArray

from jfto_msgs_py.types import Array
from jfto_topology.algorithms.ctop import Topology


def affordable(
    wishes: Sequence[Callable[[], Topology]], energy_j: Array, slot_duration_s: float | Array
) -> tuple[Topology, NDArray[np.int64]]:
    """Slots of the most demanding wish that the least powers leave affordable, cheaper ones beside.

    `wishes` make topologies of the same M slots, each cheaper than the one before; they are asked
    for one after the other and only as far as needed. `energy_j` (A,) is left for all M slots,
    whose duration is one for all or (M,). For a UAV that is short, the slots in which giving way
    saves it most give way. Returns the mixed topology and the number of the wish that each slot
    has, (M,). Where even the last wish is not affordable, what gave way stays so.
    """
    best = wishes[0]()
    chosen = np.zeros(len(best.p_min_w), dtype=np.int64)
    duration_s = np.broadcast_to(slot_duration_s, len(best.p_min_w))[:, None]
    for number, wish in enumerate(wishes[1:], 1):
        cost_j = best.p_min_w * duration_s
        if not (cost_j.sum(axis=0) > energy_j).any():
            break
        cheaper = wish()
        give_way = _slots_to_give(cost_j, cheaper.p_min_w * duration_s, energy_j)
        best = mixed(best, cheaper, give_way)
        chosen[give_way] = number
    return best, chosen


def _slots_to_give(dear_j: Array, cheap_j: Array, energy_j: Array) -> NDArray[np.bool_]:
    """Slots (M,) that must take the cheaper topology for all UAVs to pay, or all that save some.

    Costs of both are (M, A).
    """
    give = np.zeros(len(dear_j), dtype=np.bool_)
    saving_j = dear_j - cheap_j
    short_j = dear_j.sum(axis=0) - energy_j
    # The one that lacks most decides first; what it gives up helps the others too.
    for uav in np.argsort(-short_j, kind="stable"):
        missing_j = short_j[uav] - saving_j[give, uav].sum()
        if missing_j <= 0:
            continue
        order = np.argsort(np.where(give, -np.inf, saving_j[:, uav]), kind="stable")[::-1]
        order = order[: int((~give & (saving_j[:, uav] > 0)).sum())]
        enough = np.flatnonzero(np.cumsum(saving_j[order, uav]) >= missing_j)
        give[order[: enough[0] + 1] if enough.size else order] = True
    return give


def mixed(dear: Topology, cheap: Topology, give: NDArray[np.bool_]) -> Topology:
    """Slots of `cheap` where `give` (M,) says so, of `dear` elsewhere."""
    rows = {}
    for field in fields(Topology):
        ours, theirs = getattr(dear, field.name), getattr(cheap, field.name)
        rows[field.name] = np.where(give.reshape(-1, *[1] * (ours.ndim - 1)), theirs, ours)
    return Topology(**rows)
