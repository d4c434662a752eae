"""Algorithm 2 of the paper up to trimming: the least powers that list enough neighbours.

A UAV's level is its P̃min. It lists every UAV that this power reaches: power reaches by distance
rank, so a level stands for the whole list.
"""

from __future__ import annotations

import numpy as np

from jfto_msgs_py.types import Array, Flags, Ints
from jfto_world.compiled import inner, kernel


def neighbour_levels(required_w: Array, ring_w: Array, k_min: int) -> tuple[Array, Flags, Flags]:
    """Least level of each UAV so that lists are mutual, K_min long and join the fleet.

    `required_w` and `ring_w` are (M, A, A). Returns the levels in watts (M, A), the UAVs that have
    fewer than K_min candidates (M, A), and the slots that end connected (M,).
    """
    slots, uavs, _ = required_w.shape
    level_w = np.zeros((slots, uavs))
    deficit = np.zeros((slots, uavs), dtype=np.bool_)
    connected = np.zeros(slots, dtype=np.bool_)
    room = np.empty((3, uavs), dtype=np.int64)
    _fill(required_w, ring_w, k_min, level_w, deficit, connected, room)
    return level_w, deficit, connected


@kernel
def _fill(
    required_w: Array,
    ring_w: Array,
    k_min: int,
    level_w: Array,
    deficit: Flags,
    connected: Flags,
    room: Ints,
) -> None:
    """Fill the three results; `room` (3, A) is to work in: components, a queue, who is in it."""
    slots, uavs, _ = required_w.shape
    label, queue, queued = room[0], room[1], room[2]
    for m in range(slots):
        required, ring, level = required_w[m], ring_w[m], level_w[m]
        _list_nearest(ring, k_min, level, deficit[m])
        for a in range(uavs):
            queue[a], queued[a] = a, 1
        _repair(ring, level, queue, queued, uavs)
        count = _components(ring, level, label, queue)
        while count > 1:
            a, b = _shortest_missing_link(required, label)
            if a < 0:
                break
            level[a] = max(level[a], ring[a, b])
            level[b] = max(level[b], ring[b, a])
            queued[a] = queued[b] = 1
            queue[0], queue[1] = a, b
            _repair(ring, level, queue, queued, 2)
            count = _components(ring, level, label, queue)
        connected[m] = count == 1


@inner
def _list_nearest(ring: Array, k_min: int, level: Array, deficit: Flags) -> None:
    """Set each level to cover the K_min nearest candidates (eq. Pmin1)."""
    uavs = level.shape[0]
    for a in range(uavs):
        listed = 0
        while listed < k_min:
            # One ring per turn: the next level above the present one.
            beyond = np.inf
            for b in range(uavs):
                if level[a] < ring[a, b] < beyond:
                    beyond = ring[a, b]
            if beyond == np.inf:
                break
            level[a] = beyond
            for b in range(uavs):
                if ring[a, b] == beyond:
                    listed += 1
        deficit[a] = listed < k_min


@inner
def _repair(ring: Array, level: Array, queue: Ints, queued: Ints, waiting: int) -> None:
    """Raise whoever is listed without listing back, until every list is mutual.

    Raising b's level to cover a, its (K_min + κ)-th neighbour, lists all nearer ones too; the next
    candidate, its (K_min + κ + 1)-th, then bounds its power. The result does not depend on order.
    """
    uavs = level.shape[0]
    while waiting > 0:
        waiting -= 1
        a = queue[waiting]
        queued[a] = 0
        for b in range(uavs):
            if ring[a, b] <= level[a] and level[b] < ring[b, a]:
                level[b] = ring[b, a]
                if not queued[b]:
                    queued[b] = 1
                    queue[waiting] = b
                    waiting += 1


@inner
def _components(ring: Array, level: Array, label: Ints, stack: Ints) -> int:
    """Label the components of the listed graph from 0 and return their number."""
    uavs = level.shape[0]
    for a in range(uavs):
        label[a] = -1
    count = 0
    for seed in range(uavs):
        if label[seed] >= 0:
            continue
        label[seed] = count
        stack[0] = seed
        depth = 1
        while depth > 0:
            depth -= 1
            a = stack[depth]
            for b in range(uavs):
                if label[b] < 0 and ring[a, b] <= level[a]:
                    label[b] = count
                    stack[depth] = b
                    depth += 1
        count += 1
    return count


@inner
def _shortest_missing_link(required: Array, label: Ints) -> tuple[int, int]:
    """Cheapest possible link between two components; the lower indices where two cost the same."""
    uavs = label.shape[0]
    best, first, second = np.inf, -1, -1
    for a in range(uavs):
        for b in range(a + 1, uavs):
            if label[a] != label[b] and required[a, b] < best:
                best, first, second = required[a, b], a, b
    return first, second
