"""Separation, neighbours and connectivity at a row of instants."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from jfto_msgs_py.types import Array, Flags, Ints
from jfto_world.radio import degrees, pairwise_distances

Margin = Callable[[Array, Ints, Ints], Array]


@dataclass(frozen=True)
class Instants:
    """Findings at T instants, `finer` to a slot.

    `pairs` are the indices (P,) of both ends of each pair, `distance` (T, P) their distances,
    `close` (T, P) whether below d_min, `degree` (T, A) neighbours at full power, `short` (T, A)
    whether below K_min, `components` (T,) parts of the fleet, `margin_db` (T, A) surplus on the
    link to the K_min-th neighbour.
    """

    finer: int
    pairs: tuple[Ints, Ints]
    distance: Array
    close: Flags
    degree: Ints
    short: Flags
    components: Ints
    margin_db: Array

    def faults(self, kind: str) -> Flags:
        """Return where a kind of constraint is broken, (T, pairs or UAVs or 1)."""
        if kind == "connected":
            return self.components[:, None] > 1
        return self.close if kind == "separation" else self.short

    def events(self, kind: str) -> list[tuple[float, int]]:
        """Slot and column of every fault."""
        return [(row / self.finer, int(who)) for row, who in np.argwhere(self.faults(kind))]

    def hidden_events(self, kind: str) -> list[tuple[float, int]]:
        """First instant and column of every spell of faults that touches no slot's own instant."""
        faults = self.faults(kind)
        found = []
        for who in np.flatnonzero(faults.any(axis=0)):
            edge = np.diff(np.concatenate([[0], faults[:, who].astype(np.int8), [0]]))
            for begin, end in zip(
                np.flatnonzero(edge == 1), np.flatnonzero(edge == -1), strict=True
            ):
                if (begin - 1) // self.finer == (end - 1) // self.finer:
                    found.append((begin / self.finer, int(who)))
        return sorted(found)

    def worst_margin(self) -> tuple[float, int, float]:
        """Least margin in dB, the UAV and the slot it occurs at; inf where none is asked for."""
        row, uav = np.unravel_index(int(np.argmin(self.margin_db)), self.margin_db.shape)
        return float(self.margin_db[row, uav]), int(uav), float(row) / self.finer


def instants_of(
    positions_m: Array,
    *,
    reach_m: Array,
    margin_db: Margin,
    k_min: int,
    d_min_m: float,
    finer: int,
    present: Flags | None = None,
) -> Instants:
    """Look at positions (T, A, 3); a pair is linked iff within its reach_m (A, A).

    A UAV that is not `present` (T, A) has no links, is close to nobody, lacks nothing and is no
    part of the fleet.
    """
    uavs = positions_m.shape[1]
    there = np.ones(positions_m.shape[:2], dtype=np.bool_) if present is None else present
    both = there[:, :, None] & there[:, None, :]
    distance = np.where(both, pairwise_distances(positions_m), np.inf)
    linked = distance <= reach_m
    linked[:, np.arange(uavs), np.arange(uavs)] = False
    degree = degrees(linked)
    a, b = (index.astype(np.int64) for index in np.triu_indices(uavs, 1))
    margin = np.full(degree.shape, np.inf)
    if k_min > 0:
        surplus = np.full(distance.shape, -np.inf)
        surplus[:, a, b] = surplus[:, b, a] = margin_db(distance[:, a, b], a, b)
        margin = np.where(there, -np.sort(-surplus, axis=2)[:, :, k_min - 1], np.inf)
    return Instants(
        finer=finer,
        pairs=(a, b),
        distance=distance[:, a, b],
        close=distance[:, a, b] < d_min_m,
        degree=degree,
        short=there & (degree < k_min),
        components=_components(linked) - (~there).sum(axis=1),
        margin_db=margin,
    )


def _components(linked: Flags) -> Ints:
    """Number of connected components of each graph (T, A, A).

    Every UAV takes the least label among itself and its neighbours until nothing changes; a
    component keeps one label.
    """
    uavs = linked.shape[1]
    label = np.broadcast_to(np.arange(uavs), linked.shape[:2])
    for _ in range(uavs):
        heard = np.where(linked, label[:, None, :], uavs).min(axis=2)
        lower = np.minimum(label, heard)
        if np.array_equal(lower, label):
            break
        label = lower
    return (np.diff(np.sort(label, axis=1), axis=1) != 0).sum(axis=1) + 1
