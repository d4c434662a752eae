"""Connected dominating sets: few UAVs that relay for all others."""

from __future__ import annotations

import numpy as np

from jfto_msgs_py.types import Flags, Ints
from jfto_world.compiled import inner, kernel


def backbones(links: Flags) -> Flags:
    """A connected dominating set of each component of every slot, (M, A).

    `links` is (M, A, A), symmetric. Grown from the UAV of highest degree: of those already covered,
    the next member is the one that covers most of the rest (then higher degree, then lower index).
    Afterwards members that the others can do without are dropped, lowest degree first. A lone UAV
    is its own backbone.
    """
    slots, uavs, _ = links.shape
    member = np.zeros((slots, uavs), dtype=np.bool_)
    degree = links.sum(axis=2)
    order = np.argsort(degree, axis=1, kind="stable")
    marks, stack = np.empty(uavs, dtype=np.bool_), np.empty(uavs, dtype=np.int64)
    _grow_and_prune(links, degree, order, member, marks, stack)
    return member


@kernel
def _grow_and_prune(
    links: Flags, degree: Ints, order: Ints, member: Flags, marks: Flags, stack: Ints
) -> None:
    """Fill `member`; `order` (M, A) is of rising degree, `marks` and `stack` (A,) room to work."""
    slots, uavs, _ = links.shape
    for m in range(slots):
        for a in range(uavs):
            marks[a] = False
        left = uavs
        while left > 0:
            a = _next_member(links[m], degree[m], member[m], marks)
            member[m, a] = True
            for b in range(uavs):
                if not marks[b] and (b == a or links[m, a, b]):
                    marks[b] = True
                    left -= 1
        for rank in range(uavs):
            a = order[m, rank]
            if member[m, a] and _dispensable(links[m], member[m], a, marks, stack):
                member[m, a] = False


@inner
def _next_member(links: Flags, degree: Ints, member: Flags, covered: Flags) -> int:
    """Covered UAV that covers most others; where none helps, the best start of a new component."""
    uavs = links.shape[0]
    best, most = -1, 0
    for a in range(uavs):
        if not covered[a] or member[a]:
            continue
        gained = 0
        for b in range(uavs):
            if links[a, b] and not covered[b]:
                gained += 1
        if gained > most or (gained == most and best >= 0 and degree[a] > degree[best]):
            best, most = a, gained
    if best >= 0:
        return best
    for a in range(uavs):
        if not covered[a] and (best < 0 or degree[a] > degree[best]):
            best = a
    return best


@inner
def _dispensable(links: Flags, member: Flags, a: int, seen: Flags, stack: Ints) -> bool:
    """Whether the other members still cover a and its neighbours, and hang together around it."""
    uavs = links.shape[0]
    for b in range(uavs):
        if b == a or links[a, b]:
            served = b != a and member[b]
            for c in range(uavs):
                served |= c != a and member[c] and links[b, c]
            if not served:
                return False
    member[a] = False
    whole = True
    for b in range(uavs):
        if member[b] and links[a, b]:
            mark_joined(links, member, b, seen, stack)
            break
    for b in range(uavs):
        if member[b] and links[a, b] and not seen[b]:
            whole = False
    member[a] = True
    return whole


@inner
def mark_joined(links: Flags, member: Flags, origin: int, seen: Flags, stack: Ints) -> None:
    """Set `seen` (A,) to the members that `origin` reaches over members only."""
    uavs = links.shape[0]
    for b in range(uavs):
        seen[b] = b == origin
    stack[0] = origin
    depth = 1
    while depth > 0:
        depth -= 1
        a = stack[depth]
        for b in range(uavs):
            if links[a, b] and member[b] and not seen[b]:
                seen[b] = True
                stack[depth] = b
                depth += 1
