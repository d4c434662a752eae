"""The certificate on where the fleet will be: which rule is broken next, by whom and when."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from jfto_msgs_py.types import Array, Flags
from jfto_msgs_py.units import ratio_to_db
from jfto_topology.metrics import components
from jfto_world.radio import Channel, pairwise_distances


@dataclass(frozen=True)
class Rules:
    """What must hold at every instant, at P_max: `p_max_w` is (A,), `sensitivity_w` γ."""

    channel: Channel
    p_max_w: Array
    sensitivity_w: float
    k_min: int
    d_min_m: float


@dataclass(frozen=True)
class Danger:
    """A rule that is going to be broken.

    `kind` is "k_min", "d_min", "connectivity" or "energy"; `uavs` the indices at fault, () for the
    fleet. It begins at instant `first`; `margin` is the worst found from then on: dB on the link
    to the K_min-th neighbour, m of separation, links to other parts in dB, or J; negative.
    """

    kind: str
    uavs: tuple[int, ...]
    first: int
    margin: float


def look_ahead(positions_m: Array, rules: Rules, apart: Flags) -> list[Danger]:
    """Breaches of K_min, d_min and connectivity at predicted positions (T, A, 3).

    `apart` (A, A) marks the pairs whose separation is looked at. The K_min-th neighbour and the
    parts of the fleet are those at greatest power. Source: (P1kmin), (P0avoid), (P0_fullC).
    """
    distance_m = pairwise_distances(positions_m)
    weaker_w = np.minimum(rules.p_max_w[:, None], rules.p_max_w[None, :])
    with np.errstate(divide="ignore"):
        surplus_db = ratio_to_db(rules.channel.gain(distance_m) * weaker_w / rules.sensitivity_w)
    uavs = positions_m.shape[1]
    surplus_db[:, np.arange(uavs), np.arange(uavs)] = -np.inf
    return [
        *_neighbours(surplus_db, rules.k_min),
        *_separation(distance_m, rules.d_min_m, apart),
        *_connectivity(surplus_db),
    ]


def energy_danger(p_min_w: Array, slot_s: float, left_j: Array) -> list[Danger]:
    """UAVs whose energy left (A,) does not pay for the least powers (M, A) of all slots left.

    `first` is the slot, counted from the current one, that cannot be paid for. Source: (P0emax).
    """
    spent_j = np.cumsum(p_min_w, axis=0) * slot_s
    return [
        Danger("energy", (uav,), int(np.argmax(short)), float(left_j[uav] - spent_j[-1, uav]))
        for uav, short in enumerate((spent_j > left_j * (1 + 1e-9)).T)
        if short.any()
    ]


def _neighbours(surplus_db: Array, k_min: int) -> list[Danger]:
    uavs = surplus_db.shape[1]
    if not 0 < k_min < uavs:
        return []
    margin_db = -np.partition(-surplus_db, k_min - 1, axis=2)[:, :, k_min - 1]
    return [
        Danger("k_min", (uav,), int(np.argmax(margin < 0)), float(margin.min()))
        for uav, margin in enumerate(margin_db.T)
        if (margin < 0).any()
    ]


def _separation(distance_m: Array, d_min_m: float, apart: Flags) -> list[Danger]:
    found = []
    close = (distance_m < d_min_m) & np.triu(apart, 1)
    for a, b in np.argwhere(close.any(axis=0)).tolist():
        margin_m = float(distance_m[:, a, b].min() - d_min_m)
        found.append(Danger("d_min", (a, b), int(np.argmax(close[:, a, b])), margin_m))
    return found


def _connectivity(surplus_db: Array) -> list[Danger]:
    part = components(surplus_db >= 0, np.ones(surplus_db.shape[:2], dtype=np.bool_))
    split = part.max(axis=1) > 0
    if not split.any():
        return []
    other = part[:, :, None] != part[:, None, :]
    between_db = np.where(other, surplus_db, -np.inf).max(axis=(1, 2))
    return [Danger("connectivity", (), int(np.argmax(split)), float(between_db[split].min()))]
