"""Connected dominating sets: few UAVs that relay for all others."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from jfto_msgs_py.types import Flags
from jfto_world.compiled import allocating_kernel as kernel


@kernel
def backbones(links: Flags) -> Flags:
    """A connected dominating set of each component of every slot, (M, A).

    `links` is (M, A, A), symmetric. Grown from the UAV of highest degree: of those already covered,
    the next member is the one that covers most of the rest (then higher degree, then lower index).
    Afterwards members that the others can do without are dropped, lowest degree first. A lone UAV
    is its own backbone.
    """
    member = np.zeros(links.shape[:2], dtype=np.bool_)
    for m in range(links.shape[0]):
        _grow_and_prune(links[m], member[m])
    return member


@kernel
def _grow_and_prune(links: Flags, member: Flags) -> None:
    uavs = links.shape[0]
    degree = np.zeros(uavs, dtype=np.int64)
    for a in range(uavs):
        degree[a] = links[a].sum()
    covered = np.zeros(uavs, dtype=np.bool_)
    while not covered.all():
        a = _next_member(links, degree, member, covered)
        member[a] = covered[a] = True
        covered |= links[a]
    for a in np.argsort(degree, kind="mergesort"):
        if member[a] and _dispensable(links, member, a):
            member[a] = False


@kernel
def _next_member(links: Flags, degree: NDArray, member: Flags, covered: Flags) -> int:
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


@kernel
def _dispensable(links: Flags, member: Flags, a: int) -> bool:
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
    seen = np.zeros(uavs, dtype=np.bool_)
    for b in range(uavs):
        if member[b] and links[a, b]:
            seen = _members_joined(links, member, b)
            break
    for b in range(uavs):
        if member[b] and links[a, b] and not seen[b]:
            whole = False
    member[a] = True
    return whole


@kernel
def _members_joined(links: Flags, member: Flags, origin: int) -> Flags:
    """Members that `origin` reaches over members only, (A,)."""
    uavs = links.shape[0]
    seen = np.zeros(uavs, dtype=np.bool_)
    stack = np.empty(uavs, dtype=np.int64)
    seen[origin] = True
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
    return seen
