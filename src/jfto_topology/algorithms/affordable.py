"""A topology that every UAV can pay for, as demanding as it can be."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import fields

import numpy as np
from numpy.typing import NDArray

from jfto_msgs_py.types import Array
from jfto_topology.algorithms.ctop import Topology


def affordable(
    wishes: Sequence[Callable[[], Topology]], energy_j: Array, slot_duration_s: float
) -> tuple[Topology, NDArray[np.int64]]:
    """Slots of the most demanding wish that the least powers leave affordable, cheaper ones beside.

    `wishes` make topologies of the same M slots, each cheaper than the one before; they are asked
    for one after the other and only as far as needed. `energy_j` (A,) is left for all M slots. For
    a UAV that is short, the slots in which giving way saves it most give way. Returns the mixed
    topology and the number of the wish that each slot has, (M,). Where even the last wish is not
    affordable, it is the answer.
    """
    best = wishes[0]()
    chosen = np.zeros(len(best.p_min_w), dtype=np.int64)
    for number, wish in enumerate(wishes[1:], 1):
        if not _short(best, energy_j, slot_duration_s).any():
            break
        cheaper = wish()
        give_way = _slots_to_give(best, cheaper, energy_j, slot_duration_s)
        best = mixed(best, cheaper, give_way)
        chosen[give_way] = number
    return best, chosen


def _short(topology: Topology, energy_j: Array, slot_duration_s: float) -> NDArray[np.bool_]:
    return topology.p_min_w.sum(axis=0) * slot_duration_s > energy_j


def _slots_to_give(
    dear: Topology, cheap: Topology, energy_j: Array, slot_duration_s: float
) -> NDArray[np.bool_]:
    """Slots (M,) that must take the cheaper topology for all UAVs to pay, or all slots."""
    give = np.zeros(len(dear.p_min_w), dtype=np.bool_)
    saving_j = (dear.p_min_w - cheap.p_min_w) * slot_duration_s
    cost_j = dear.p_min_w.sum(axis=0) * slot_duration_s
    # The one that lacks most decides first; what it gives up helps the others too.
    for uav in np.argsort(energy_j - cost_j, kind="stable"):
        missing_j = cost_j[uav] - saving_j[give, uav].sum() - energy_j[uav]
        if missing_j <= 0:
            continue
        order = np.argsort(np.where(give, -np.inf, saving_j[:, uav]), kind="stable")[::-1]
        order = order[: int((~give).sum())]
        gained = np.cumsum(saving_j[order, uav])
        enough = np.flatnonzero(gained >= missing_j)
        if not enough.size:
            return np.ones_like(give)
        give[order[: enough[0] + 1]] = True
    return give


def mixed(dear: Topology, cheap: Topology, give: NDArray[np.bool_]) -> Topology:
    """Slots of `cheap` where `give` (M,) says so, of `dear` elsewhere."""
    rows = {}
    for field in fields(Topology):
        ours, theirs = getattr(dear, field.name), getattr(cheap, field.name)
        rows[field.name] = np.where(give.reshape(-1, *[1] * (ours.ndim - 1)), theirs, ours)
    return Topology(**rows)
