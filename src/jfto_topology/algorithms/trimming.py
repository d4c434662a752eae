"""Degrees cut down to K_min + δ, for the sake of spatial reuse (P3kmax)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from jfto_msgs_py.types import Array, Flags
from jfto_world.compiled import allocating_kernel as kernel

# Kinds of links to cut, in this order.
CHOICES = 4


@kernel
def trimmed_lists(
    required_w: Array, ring_w: Array, level_w: Array, k_min: int, delta: int
) -> tuple[Flags, NDArray[np.int64], Flags]:
    """Active links after trimming, degrees before it, and UAVs left with too many neighbours.

    `required_w` and `ring_w` are (M, A, A) and `level_w` (M, A) holds mutual lists. A link goes
    only while both ends keep K_min neighbours and the fleet stays as connected as it was. A link
    that vanishes when one end lowers its power goes before one that merely leaves the lists, then
    one between two UAVs that both have too many before others, then the longest one. Returns
    (M, A, A), (M, A), (M, A).
    """
    slots, uavs, _ = required_w.shape
    active = np.zeros((slots, uavs, uavs), dtype=np.bool_)
    before = np.zeros((slots, uavs), dtype=np.int64)
    over = np.zeros((slots, uavs), dtype=np.bool_)
    for m in range(slots):
        for a in range(uavs):
            for b in range(uavs):
                if ring_w[m, a, b] <= level_w[m, a]:
                    active[m, a, b] = True
                    before[m, a] += 1
        degree = before[m].copy()
        if degree.max() > k_min + delta:
            _trim(required_w[m], ring_w[m], active[m], degree, k_min, delta)
        over[m] = degree > k_min + delta
    return active, before, over


@kernel
def _trim(
    required: Array, ring: Array, active: Flags, degree: NDArray, k_min: int, delta: int
) -> None:
    uavs = degree.shape[0]
    ends = _longest_first(required, active)
    # Links and degrees only ever go, so a link that must stay now must stay for good.
    settled = np.zeros(ends.shape[0], dtype=np.bool_)
    farthest = np.empty((uavs, 2), dtype=np.int64)
    for a in range(uavs):
        _two_farthest(ring, active, a, farthest)
    choice = 0
    while choice < CHOICES:
        found = -1
        for e in range(ends.shape[0]):
            a, b = ends[e, 0], ends[e, 1]
            lesser, greater = min(degree[a], degree[b]), max(degree[a], degree[b])
            # Choices 0 and 2 cut between two UAVs in excess, which spares a link elsewhere.
            excess = (lesser if choice % 2 == 0 else greater) - k_min - delta
            if settled[e] or excess <= 0:
                continue
            # Choices 0 and 1 cut what one end's power can drop, 2 and 3 what only the lists can.
            if choice < 2 and not (
                _beyond_power(required, ring, farthest, a, b)
                or _beyond_power(required, ring, farthest, b, a)
            ):
                continue
            settled[e] = True
            if lesser > k_min and _detour(active, a, b):
                found = e
                break
        if found < 0:
            choice += 1
            continue
        a, b = ends[found, 0], ends[found, 1]
        active[a, b] = active[b, a] = False
        degree[a] -= 1
        degree[b] -= 1
        _two_farthest(ring, active, a, farthest)
        _two_farthest(ring, active, b, farthest)
        choice = 0


@kernel
def _longest_first(required: Array, active: Flags) -> NDArray[np.int64]:
    """Active links (L, 2) by falling power, then by index."""
    uavs = active.shape[0]
    ends = np.empty((uavs * (uavs - 1) // 2, 2), dtype=np.int64)
    count = 0
    for a in range(uavs):
        for b in range(a + 1, uavs):
            if not active[a, b]:
                continue
            place = count
            while place > 0 and required[ends[place - 1, 0], ends[place - 1, 1]] < required[a, b]:
                ends[place, 0], ends[place, 1] = ends[place - 1, 0], ends[place - 1, 1]
                place -= 1
            ends[place, 0], ends[place, 1] = a, b
            count += 1
    return ends[:count]


@kernel
def _two_farthest(ring: Array, active: Flags, a: int, farthest: NDArray) -> None:
    """Note a's two most costly active neighbours, -1 where there is none."""
    first, second = -1, -1
    for b in range(active.shape[0]):
        if not active[a, b]:
            continue
        if first < 0 or ring[a, b] > ring[a, first]:
            first, second = b, first
        elif second < 0 or ring[a, b] > ring[a, second]:
            second = b
    farthest[a, 0], farthest[a, 1] = first, second


@kernel
def _beyond_power(required: Array, ring: Array, farthest: NDArray, a: int, b: int) -> bool:
    """Whether a, once it serves its other neighbours only, no longer reaches b."""
    other = farthest[a, 1] if farthest[a, 0] == b else farthest[a, 0]
    return other < 0 or required[a, b] > ring[a, other]


@kernel
def _detour(active: Flags, a: int, b: int) -> bool:
    """Whether a still reaches b over others, so that their own link is not a bridge."""
    uavs = active.shape[0]
    for c in range(uavs):
        if active[a, c] and active[c, b]:
            return True
    seen = np.zeros(uavs, dtype=np.bool_)
    stack = np.empty(uavs, dtype=np.int64)
    seen[a] = True
    stack[0] = a
    depth = 1
    while depth > 0:
        depth -= 1
        c = stack[depth]
        for d in range(uavs):
            if active[c, d] and not seen[d] and not (c == a and d == b):
                if d == b:
                    return True
                seen[d] = True
                stack[depth] = d
                depth += 1
    return False
