"""Neighbours, connectivity and separation over the search's time grid.

Sets of UAVs are bits of a uint64. A constraint that does not hold costs BASE plus SLOPE times the
relative excess over the limit, per UAV (or pair, or missing link) and grid instant.
"""

from __future__ import annotations

import numpy as np

from jfto_planner.routing.kernel.tables import State, Tables, Work
from jfto_world.compiled import inner

BASE = 0.2
SLOPE = 2.0
_ONE, _ZERO = np.uint64(1), np.uint64(0)


@inner
def scan_pair(
    pos_a: np.ndarray,
    pos_b: np.ndarray,
    mask_a: np.ndarray,
    mask_b: np.ndarray,
    bits: tuple[int, int],
    limits_sq: tuple[float, float],
    span: tuple[int, int],
) -> int:
    """Set the link bits of a pair at the instants of a span, both its ends among them.

    Returns how often the pair is nearer than `limits_sq[1]`.
    """
    reach_sq, near_sq = limits_sq
    bit_a, bit_b = np.uint64(bits[0]), np.uint64(bits[1])
    near = 0
    for slot in range(span[0], span[1] + 1):
        dx = pos_a[0, slot] - pos_b[0, slot]
        dy = pos_a[1, slot] - pos_b[1, slot]
        dz = pos_a[2, slot] - pos_b[2, slot]
        d_sq = dx * dx + dy * dy + dz * dz
        link = np.uint64(d_sq <= reach_sq)
        mask_a[slot] |= link << bit_b
        mask_b[slot] |= link << bit_a
        near += 1 if d_sq < near_sq else 0
    return near


@inner
def pair_closeness(
    pos_a: np.ndarray, pos_b: np.ndarray, first: int, last: int, d_min: float
) -> float:
    """Penalty of a pair for coming closer than d_min between the instants first - 1 … last."""
    cost = 0.0
    for slot in range(max(first, 1), last + 1):
        x = pos_a[0, slot - 1] - pos_b[0, slot - 1]
        y = pos_a[1, slot - 1] - pos_b[1, slot - 1]
        z = pos_a[2, slot - 1] - pos_b[2, slot - 1]
        dx = pos_a[0, slot] - pos_b[0, slot] - x
        dy = pos_a[1, slot] - pos_b[1, slot] - y
        dz = pos_a[2, slot] - pos_b[2, slot] - z
        speed_sq = dx * dx + dy * dy + dz * dz
        when = 0.0
        if speed_sq > 0.0:
            when = min(1.0, max(0.0, -(x * dx + y * dy + z * dz) / speed_sq))
        x, y, z = x + when * dx, y + when * dy, z + when * dz
        d_sq = x * x + y * y + z * z
        if d_sq < d_min * d_min:
            cost += BASE + SLOPE * (1.0 - np.sqrt(d_sq) / d_min)
    return cost


@inner
def renew_pairs(
    tables: Tables, cur: State, cand: State, work: Work, first: int, last: int
) -> float:
    """Renew neighbour sets and pair closeness of the changed routes; returns total closeness."""
    uavs = cand.size.shape[0]
    keep = ~_ZERO
    for a in range(uavs):
        if work.changed[a]:
            keep &= ~(_ONE << np.uint64(a))
    for b in range(uavs):
        if work.changed[b]:
            for slot in range(first, last + 1):
                cand.mask[b, slot] = _ZERO
        else:
            for slot in range(first, last + 1):
                cand.mask[b, slot] = cur.mask[b, slot] & keep
    total = 0.0
    for a in range(uavs):
        for b in range(a):
            close = cur.close[a, b]
            if work.changed[a] or work.changed[b]:
                pos_a = cand.pos[a] if work.changed[a] else cur.pos[a]
                pos_b = cand.pos[b] if work.changed[b] else cur.pos[b]
                limits = (tables.reach[a, b] ** 2, tables.near_sq[a, b])
                near = scan_pair(
                    pos_a, pos_b, cand.mask[a], cand.mask[b], (a, b), limits, (first, last)
                )
                if close > 0.0:
                    close = pair_closeness(cur.pos[a], cur.pos[b], 1, first - 1, tables.d_min)
                if near > 0:
                    close += pair_closeness(pos_a, pos_b, first, last, tables.d_min)
            cand.close[a, b] = close
            total += close
    return total


@inner
def reached(mask: np.ndarray, slot: int, seen: np.uint64) -> np.uint64:
    """Return all UAVs that those in `seen` reach over links."""
    uavs = mask.shape[0]
    done = _ZERO
    while done != seen:
        todo = seen & ~done
        done = seen
        for a in range(uavs):
            if todo & (_ONE << np.uint64(a)):
                seen |= mask[a, slot]
    return seen


@inner
def slot_is_sound(mask: np.ndarray, slot: int, k_min: int, everyone: np.uint64) -> bool:
    """Tell whether all UAVs have k_min neighbours at an instant and form one component."""
    for a in range(mask.shape[0]):
        links = mask[a, slot]
        for _ in range(k_min - 1):
            links &= links - _ONE
        if k_min > 0 and links == _ZERO:
            return False
    if (mask[0, slot] | _ONE) == everyone:
        return True
    return reached(mask, slot, _ONE) == everyone


@inner
def fill_ratios(tables: Tables, cur: State, cand: State, work: Work, slot: int) -> None:
    """Set work.ratio to distance / reach of all pairs at an instant."""
    uavs = cand.size.shape[0]
    for a in range(uavs):
        pos_a = cand.pos[a] if work.changed[a] else cur.pos[a]
        for b in range(a):
            pos_b = cand.pos[b] if work.changed[b] else cur.pos[b]
            dx = pos_a[0, slot] - pos_b[0, slot]
            dy = pos_a[1, slot] - pos_b[1, slot]
            dz = pos_a[2, slot] - pos_b[2, slot]
            ratio = np.sqrt(dx * dx + dy * dy + dz * dz) / tables.reach[a, b]
            work.ratio[a, b] = ratio
            work.ratio[b, a] = ratio


@inner
def kth_nearest(work: Work, uav: int, k: int) -> float:
    """Return the k-th smallest entry of a row of work.ratio, its diagonal left out."""
    filled = 0
    for b in range(work.ratio.shape[0]):
        value = work.ratio[uav, b]
        if b == uav or (filled == k and value >= work.nearest[k - 1]):
            continue
        i = filled if filled < k else k - 1
        while i > 0 and work.nearest[i - 1] > value:
            work.nearest[i] = work.nearest[i - 1]
            i -= 1
        work.nearest[i] = value
        filled = min(filled + 1, k)
    return work.nearest[k - 1]


@inner
def slot_deficit(
    tables: Tables, cur: State, cand: State, work: Work, slot: int, everyone: np.uint64
) -> float:
    """Penalty for missing neighbours and missing connections at one instant."""
    fill_ratios(tables, cur, cand, work, slot)
    uavs = cand.size.shape[0]
    cost = 0.0
    if tables.k_min > 0:
        for a in range(uavs):
            ratio = kth_nearest(work, a, tables.k_min)
            if ratio > 1.0:
                cost += BASE + SLOPE * (ratio - 1.0)
    seen = reached(cand.mask, slot, _ONE)
    while seen != everyone:
        gap, nearest = np.inf, 0
        for a in range(uavs):
            if seen & (_ONE << np.uint64(a)):
                for b in range(uavs):
                    if not seen & (_ONE << np.uint64(b)) and work.ratio[a, b] < gap:
                        gap, nearest = work.ratio[a, b], b
        cost += BASE + SLOPE * max(0.0, gap - 1.0)
        seen = reached(cand.mask, slot, seen | (_ONE << np.uint64(nearest)))
    return cost


@inner
def renew_deficits(
    tables: Tables, cur: State, cand: State, work: Work, first: int, last: int, allowance: float
) -> float:
    """Renew cand.deficit at the instants first … last; returns its sum over all instants.

    Stops with inf as soon as the sum exceeds `allowance`.
    """
    uavs = cand.size.shape[0]
    everyone = ~_ZERO >> np.uint64(64 - uavs)
    cost = 0.0
    if cur.total[2] > 0.0:
        for slot in range(first):
            cost += cur.deficit[slot]
    for slot in range(first, last + 1):
        value = 0.0
        if not slot_is_sound(cand.mask, slot, tables.k_min, everyone):
            value = slot_deficit(tables, cur, cand, work, slot, everyone)
        cand.deficit[slot] = value
        cost += value
        if cost > allowance:
            return np.inf
    return cost
