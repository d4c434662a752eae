"""Degrees cut down to K_min + δ, for the sake of spatial reuse (P3kmax)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from jfto_msgs_py.types import Array, Flags, Ints
from jfto_world.compiled import inner, kernel
from jfto_world.kernel_struct import KernelStruct

# Kinds of links to cut, in this order.
CHOICES = 4


def trimmed_lists(
    required_w: Array, ring_w: Array, level_w: Array, k_min: int, delta: int
) -> tuple[Flags, Ints, Flags]:
    """Active links after trimming, degrees before it, and UAVs left with too many neighbours.

    `required_w` and `ring_w` are (M, A, A) and `level_w` (M, A) holds mutual lists. A link goes
    only while both ends keep K_min neighbours and the fleet stays as connected as it was. A link
    that vanishes when one end lowers its power goes before one that merely leaves the lists, then
    one between two UAVs that both have too many before others, then the longest one. Returns
    (M, A, A), (M, A), (M, A).
    """
    active = ring_w <= level_w[..., None]
    before = active.sum(axis=2)
    degree = before.copy()
    uavs = active.shape[1]
    room = Room(
        ends=np.empty((uavs * (uavs - 1) // 2, 2), dtype=np.int64),
        settled=np.empty(uavs * (uavs - 1) // 2, dtype=np.bool_),
        farthest=np.empty((uavs, 2), dtype=np.int64),
        seen=np.empty(uavs, dtype=np.bool_),
        stack=np.empty(uavs, dtype=np.int64),
    )
    _trim_all(required_w, ring_w, active, degree, k_min, delta, room)
    return active, before, degree > k_min + delta


@dataclass(frozen=True, eq=False)
class Room(KernelStruct):
    """Room to work in: possible links (L, 2), which of them are settled (L,), each UAV's two most
    costly neighbours (A, 2), and what a walk over links has seen (A,) and has yet to see (A,).
    """

    ends: Ints
    settled: Flags
    farthest: Ints
    seen: Flags
    stack: Ints


@kernel
def _trim_all(
    required_w: Array,
    ring_w: Array,
    active: Flags,
    degree: Ints,
    k_min: int,
    delta: int,
    room: Room,
) -> None:
    for m in range(active.shape[0]):
        most = 0
        for a in range(active.shape[1]):
            most = max(most, degree[m, a])
        if most > k_min + delta:
            _trim(required_w[m], ring_w[m], active[m], degree[m], k_min, delta, room)


@inner
def _trim(
    required: Array, ring: Array, active: Flags, degree: Ints, k_min: int, delta: int, room: Room
) -> None:
    ends, settled, farthest = room.ends, room.settled, room.farthest
    count = _longest_first(required, active, ends)
    # Links and degrees only ever go, so a link that must stay now must stay for good.
    for e in range(count):
        settled[e] = False
    for a in range(degree.shape[0]):
        _two_farthest(ring, active, a, farthest)
    choice = 0
    while choice < CHOICES:
        found = -1
        for e in range(count):
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
            if lesser > k_min and detour(active, a, b, room.seen, room.stack):
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


@inner
def _longest_first(required: Array, active: Flags, ends: Ints) -> int:
    """Write the active links into `ends` by falling power, then by index; returns their number."""
    uavs = active.shape[0]
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
    return count


@inner
def _two_farthest(ring: Array, active: Flags, a: int, farthest: Ints) -> None:
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


@inner
def _beyond_power(required: Array, ring: Array, farthest: Ints, a: int, b: int) -> bool:
    """Whether a, once it serves its other neighbours only, no longer reaches b."""
    other = farthest[a, 1] if farthest[a, 0] == b else farthest[a, 0]
    return other < 0 or required[a, b] > ring[a, other]


@inner
def detour(active: Flags, a: int, b: int, seen: Flags, stack: Ints) -> bool:
    """Whether a still reaches b over others, so that their own link is not a bridge."""
    uavs = active.shape[0]
    for c in range(uavs):
        if active[a, c] and active[c, b]:
            return True
    for c in range(uavs):
        seen[c] = c == a
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
