"""Links exchanged for better ones: a local search over who lists whom.

A UAV's power serves its farthest listed neighbour and stays below the next one beyond. So a link
changes the power at both its ends, and with it what their other links carry.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from jfto_msgs_py.types import Array, Flags, Ints
from jfto_topology.algorithms.intervals import RING_WIDTH
from jfto_topology.algorithms.trimming import detour
from jfto_world.compiled import inner, kernel
from jfto_world.kernel_struct import KernelStruct

# A gain below so many bits per second and hertz is rounding.
LEAST_GAIN = 1e-9
# Products of ratios stay far inside what a double holds.
_LARGE = 1e250


@dataclass(frozen=True, eq=False)
class Costs(KernelStruct):
    """What links of M slots cost and yield.

    `required_w` (M, A, A) is the power that each takes and `ring_w` that of its ring
    (`ring_powers`), `caps_w` (A,) the greatest powers, `snr` (M, A, A) the ratio of signal to noise
    that a watt makes. Arrays are contiguous.
    """

    required_w: Array
    ring_w: Array
    caps_w: Array
    snr: Array


@dataclass(frozen=True, eq=False)
class Slot(KernelStruct):
    """One slot's rows of `Costs`, its links, and room to work in.

    `active` (A, A) are links and `degree` (A,) their number; `upper` (A, A) is the power of a row's
    UAV when that column's UAV is the farthest it lists; `worth` (A,) what each UAV sends over its
    links, in bit/s/Hz; `seen` and `stack` (A,) are for walks.
    """

    required: Array
    ring: Array
    snr: Array
    active: Flags
    degree: Ints
    upper: Array
    worth: Array
    seen: Flags
    stack: Ints


def carried(active: Flags, costs: Costs) -> Array:
    """Σ over links of the mean rate of both directions at the greatest safe powers, bit/s/Hz (M,).

    `active` is (M, A, A).
    """
    bits = np.zeros(len(active))
    _solve(np.ascontiguousarray(active), costs, -1, 0, _room(active.shape[1]), bits)
    return bits


def exchanged_links(active: Flags, costs: Costs, k_min: int, most: int) -> Flags:
    """Links (M, A, A) that carry at least as much, with degrees from K_min to `most`.

    Links are added, exchanged one for one and two for two, and one given for two, as long as the
    sum grows; links of those above `most` go where they can be spared. Nobody falls below K_min by
    it or comes above `most`, and who was joined stays joined.
    """
    better = np.array(active, order="C")
    _solve(better, costs, k_min, most, _room(active.shape[1]), np.zeros(len(active)))
    return better


def _room(uavs: int) -> Slot:
    air = (np.zeros((uavs, uavs)), np.zeros((uavs, uavs)), np.zeros((uavs, uavs)))
    links = (np.zeros((uavs, uavs), dtype=np.bool_), np.zeros(uavs, dtype=np.int64))
    walk = (np.zeros(uavs, dtype=np.bool_), np.zeros(uavs, dtype=np.int64))
    return Slot(*air, *links, np.zeros((uavs, uavs)), np.zeros(uavs), *walk)


@kernel
def _solve(active: Flags, costs: Costs, k_min: int, most: int, slot: Slot, bits: Array) -> None:
    """Exchange links of every slot in place, unless `k_min` is negative, and sum up the rates."""
    slots, uavs = active.shape[0], active.shape[1]
    for m in range(slots):
        for a in range(uavs):
            slot.degree[a] = 0
            for b in range(uavs):
                slot.required[a, b] = costs.required_w[m, a, b]
                slot.ring[a, b] = costs.ring_w[m, a, b]
                slot.snr[a, b] = costs.snr[m, a, b]
                slot.active[a, b] = active[m, a, b]
                slot.degree[a] += active[m, a, b]
        for a in range(uavs):
            for b in range(uavs):
                level, cap = slot.ring[a, b], costs.caps_w[a]
                slot.upper[a, b] = _greatest_power(slot.required, level, a, cap)
        for a in range(uavs):
            slot.worth[a] = _worth(slot, a, -1, -1)
        # Every exchange gains; a slot is done when a whole turn finds none.
        turns = uavs * uavs if k_min >= 0 else 0
        while turns > 0 and _turn(slot, k_min, most):
            turns -= 1
        bits[m] = 0.0
        for a in range(uavs):
            bits[m] += slot.worth[a] / 2
            for b in range(uavs):
                active[m, a, b] = slot.active[a, b]


@inner
def _greatest_power(required: Array, level: float, a: int, cap: float) -> float:
    """Greatest safe power of a with this level: below the next candidate, at most its cap."""
    beyond = np.inf
    for c in range(required.shape[0]):
        if level < required[a, c] < beyond:
            beyond = required[a, c]
    return min(beyond * (1.0 - RING_WIDTH / 2), cap)


@inner
def _worth(slot: Slot, a: int, out: int, joins: int) -> float:
    """What a sends over its links without `out` and with `joins`, -1 for none, in bit/s/Hz."""
    uavs = slot.degree.shape[0]
    farthest = -1
    for b in range(uavs):
        listed = (slot.active[a, b] and b != out) or b == joins
        if listed and (farthest < 0 or slot.ring[a, b] > slot.ring[a, farthest]):
            farthest = b
    if farthest < 0:
        return 0.0
    power, product, bits = slot.upper[a, farthest], 1.0, 0.0
    for b in range(uavs):
        if (slot.active[a, b] and b != out) or b == joins:
            product *= 1.0 + power * slot.snr[a, b]
            if product > _LARGE:
                bits += np.log2(product)
                product = 1.0
    return float(bits + np.log2(product))


@inner
def _turn(slot: Slot, k_min: int, most: int) -> bool:
    """Try every exchange once; whether one was made."""
    uavs = slot.degree.shape[0]
    found = False
    for a in range(uavs):
        for b in range(a + 1, uavs):
            if slot.active[a, b]:
                found |= _spare(slot, a, b, k_min, most) or _give_for_two(slot, a, b, most)
            elif slot.required[a, b] < np.inf:
                if slot.degree[a] < most and slot.degree[b] < most:
                    _link(slot, a, b, True)
                    found = True
                elif slot.degree[a] < most:
                    found |= _exchange_one(slot, a, b, k_min)
                elif slot.degree[b] < most:
                    found |= _exchange_one(slot, b, a, k_min)
                else:
                    found |= _exchange_two(slot, a, b, k_min)
    return found


@inner
def _spare(slot: Slot, a: int, b: int, k_min: int, most: int) -> bool:
    """Cut a link of somebody with too many, which the exchanges so far may have made possible."""
    if max(slot.degree[a], slot.degree[b]) <= most or min(slot.degree[a], slot.degree[b]) <= k_min:
        return False
    _link(slot, a, b, False)
    if not detour(slot.active, a, b, slot.seen, slot.stack):
        _link(slot, a, b, True)
        return False
    return True


@inner
def _exchange_one(slot: Slot, a: int, b: int, k_min: int) -> bool:
    """Link a, which has room, with b, which gives up its least valuable neighbour for it."""
    best, best_gain = -1, LEAST_GAIN
    gain_a = _worth(slot, a, -1, b) - slot.worth[a]
    for c in range(slot.degree.shape[0]):
        if slot.active[b, c] and slot.degree[c] > k_min:
            gain = gain_a + _worth(slot, b, c, a) - slot.worth[b]
            gain += _worth(slot, c, b, -1) - slot.worth[c]
            if gain > best_gain:
                best, best_gain = c, gain
    if best < 0:
        return False
    _link(slot, a, b, True)
    _link(slot, b, best, False)
    if not detour(slot.active, b, best, slot.seen, slot.stack):
        _link(slot, b, best, True)
        _link(slot, a, b, False)
        return False
    return True


@inner
def _exchange_two(slot: Slot, a: int, b: int, k_min: int) -> bool:
    """Link a and b, which have no room, each giving up a neighbour; those two may be linked too."""
    uavs = slot.degree.shape[0]
    first, second, both, best_gain = -1, -1, False, LEAST_GAIN
    for c in range(uavs):
        if not slot.active[a, c]:
            continue
        gain_a = _worth(slot, a, c, b) - slot.worth[a] - slot.worth[c]
        less_c = _worth(slot, c, a, -1)
        for d in range(uavs):
            # One that loses both would need a sum of its own.
            if not slot.active[b, d] or d == c:
                continue
            gain = gain_a + _worth(slot, b, d, a) - slot.worth[b] - slot.worth[d]
            if min(slot.degree[c], slot.degree[d]) > k_min:
                alone = gain + less_c + _worth(slot, d, b, -1)
                if alone > best_gain:
                    first, second, both, best_gain = c, d, False, alone
            if _possible(slot, c, d):
                gain += _worth(slot, c, a, d) + _worth(slot, d, b, c)
                if gain > best_gain:
                    first, second, both, best_gain = c, d, True, gain
    if first < 0:
        return False
    _link(slot, a, b, True)
    _link(slot, a, first, False)
    _link(slot, b, second, False)
    if both:
        _link(slot, first, second, True)
    joined = detour(slot.active, a, first, slot.seen, slot.stack)
    if joined and detour(slot.active, b, second, slot.seen, slot.stack):
        return True
    if both:
        _link(slot, first, second, False)
    _link(slot, b, second, True)
    _link(slot, a, first, True)
    _link(slot, a, b, False)
    return False


@inner
def _give_for_two(slot: Slot, c: int, d: int, most: int) -> bool:
    """Give up the link of c and d where each gets another one for it, with somebody with room."""
    uavs = slot.degree.shape[0]
    first, second, best_gain = -1, -1, LEAST_GAIN
    for a in range(uavs):
        if slot.degree[a] >= most or a in (c, d) or not _possible(slot, a, c):
            continue
        gain_a = _worth(slot, a, -1, c) - slot.worth[a]
        gain_a += _worth(slot, c, d, a) - slot.worth[c]
        for b in range(uavs):
            if slot.degree[b] >= most or b in (a, c, d) or not _possible(slot, b, d):
                continue
            gain = gain_a + _worth(slot, b, -1, d) - slot.worth[b]
            gain += _worth(slot, d, c, b) - slot.worth[d]
            if gain > best_gain:
                first, second, best_gain = a, b, gain
    if first < 0:
        return False
    _link(slot, first, c, True)
    _link(slot, second, d, True)
    _link(slot, c, d, False)
    if not detour(slot.active, c, d, slot.seen, slot.stack):
        _link(slot, c, d, True)
        _link(slot, second, d, False)
        _link(slot, first, c, False)
        return False
    return True


@inner
def _possible(slot: Slot, a: int, b: int) -> bool:
    """Whether a and b are not linked but could be."""
    return not slot.active[a, b] and slot.required[a, b] < np.inf


@inner
def _link(slot: Slot, a: int, b: int, on: bool) -> None:
    """Make or cut a link, with its ends' degrees and worth."""
    slot.active[a, b] = slot.active[b, a] = on
    step = 1 if on else -1
    slot.degree[a] += step
    slot.degree[b] += step
    slot.worth[a] = _worth(slot, a, -1, -1)
    slot.worth[b] = _worth(slot, b, -1, -1)
