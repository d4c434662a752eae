"""Exact power allocation of one UAV: one water level, found by Newton steps on both floors.

A UAV's share of (P4) is: maximise Σ_n Σ_b ln(1 + p_n / s_nb) subject to low ≤ p_n ≤ high and
Σ_n p_n ≤ budget, where s = σ²B / h is the power that would arrive at 0 dB over the noise. With the
multiplier λ = 1/u of the budget, the best p_n solves G_n(p) = u, clipped to its interval, where
G_n(p) = 1 / Σ_b 1/(p + s_nb). G_n is increasing and concave, almost a straight line, so Newton's
method from the left climbs to p_n(u) without ever passing it, in two to four steps; Σ_n p_n(u) is
increasing in u, so a second, bracketed Newton finds the level that spends the budget.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from jfto_msgs_py.types import Array, Flags, Ints
from jfto_world.compiled import inner, kernel
from jfto_world.kernel_struct import KernelStruct

OUTER_STEPS = 200
INNER_STEPS = 60
# Share of the budget that may be left over, by rounding alone.
CLOSE = 1e-14


def fill_rows(
    linked: Flags,
    gain: Array,
    noise_w: float,
    low_w: Array,
    high_w: Array,
    budget_w: Array,
) -> tuple[Array, Array]:
    """Powers (M, R) and water levels (R,) in watts of R UAVs over M = N + 1 slots.

    `linked` and `gain` are (M, R, B), the intervals (M, R), `budget_w` (R,) bounds the sum over
    slots 1..N. Slot 0 is free and follows the same level. The level is inf where the budget does
    not bind. The caller has checked low ≤ high and Σ low ≤ budget. A slot without links gets low.
    """
    slots, rows, _ = linked.shape
    heard = (linked & (gain > 0.0)).transpose(1, 0, 2)
    fleet = Fleet(
        terms=noise_w / gain.transpose(1, 0, 2)[heard],
        start=np.concatenate([[0], np.cumsum(heard.sum(axis=2))]),
        low=np.array(low_w.T, dtype=np.float64, order="C"),
        high=np.array(high_w.T, dtype=np.float64, order="C"),
        power=np.empty((rows, slots)),
        at_low=np.empty(slots),
        at_high=np.empty(slots),
        mean=np.empty(slots),
        other=np.empty(slots),
    )
    level = np.empty(rows)
    _fill_all(fleet, np.array(budget_w, dtype=np.float64), level)
    return fleet.power.T.copy(), level


@dataclass(frozen=True, eq=False)
class Fleet(KernelStruct):
    """R UAVs over M slots, and room for one of them.

    `terms` holds the s of all links, UAV by UAV and slot by slot; those of UAV r's slot m begin at
    `start[r M + m]`. `low` and `high` bound the powers, `power` receives them, all (R, M). `at_low`
    and `at_high` (M,) are the levels at which the UAV that is worked on meets its bounds, `mean`
    the mean s of each slot, `other` a second row of powers.
    """

    terms: Array
    start: Ints
    low: Array
    high: Array
    power: Array
    at_low: Array
    at_high: Array
    mean: Array
    other: Array


@kernel
def _fill_all(fleet: Fleet, budget: Array, level: Array) -> None:
    for r in range(level.shape[0]):
        level[r] = _fill(fleet, r, budget[r])


@inner
def _fill(fleet: Fleet, r: int, budget: float) -> float:
    """Write the best powers of one UAV and return its water level."""
    left, right, most = np.inf, 0.0, 0.0
    slots = fleet.mean.shape[0]
    for m in range(slots):
        begin, end = fleet.start[r * slots + m], fleet.start[r * slots + m + 1]
        if begin == end:
            # No rate to gain: the level never lifts the power off its floor.
            fleet.at_low[m], fleet.at_high[m], fleet.mean[m] = np.inf, np.inf, 0.0
        else:
            fleet.at_low[m] = _level_at(fleet.terms, begin, end, fleet.low[r, m])
            fleet.at_high[m] = _level_at(fleet.terms, begin, end, fleet.high[r, m])
            total = 0.0
            for k in range(begin, end):
                total += fleet.terms[k]
            fleet.mean[m] = total / (end - begin)
        if m > 0:
            most += fleet.low[r, m] if begin == end else fleet.high[r, m]
            if begin < end:
                left, right = min(left, fleet.at_low[m]), max(right, fleet.at_high[m])
    if most <= budget:
        _pour(fleet, r, np.inf, fleet.power[r])
        return np.inf
    return _search(fleet, r, budget, left, right)


@inner
def _search(fleet: Fleet, r: int, budget: float, left: float, right: float) -> float:
    """Level between `left` and `right` that spends the budget; leaves the powers in `power`."""
    total, _ = _pour(fleet, r, left, fleet.power[r])
    if budget - total <= CLOSE * budget:
        return left
    # Exact where every slot is linked, off its bounds and has equal gains: a good first guess.
    slots, spread = fleet.mean.shape[0], 0.0
    for m in range(1, slots):
        spread += fleet.mean[m]
    level = (budget + spread) / (fleet.start[(r + 1) * slots] - fleet.start[r * slots + 1])
    if not left < level < right:
        level = left + 0.5 * (right - left)
    for step in range(OUTER_STEPS):
        total, slope = _pour(fleet, r, level, fleet.power[r])
        missing = budget - total
        if 0.0 <= missing <= CLOSE * budget:
            return level
        if missing > 0.0:
            left = level
        else:
            right = level
            if -missing <= CLOSE * budget:
                # Overdrawn by rounding: aim as far below the budget.
                missing *= 2.0
        following = level + missing / slope if slope > 0.0 else np.inf
        # Every fourth step halves the bracket, so that a kinked sum cannot make Newton crawl.
        if not left < following < right or step % 4 == 3:
            following = left + 0.5 * (right - left)
        if not left < following < right:
            break
        level = following
    # The bracket has closed to neighbouring numbers and the sum jumps across the budget between
    # them (noise far above signal): every mixture of both ends is optimal; take the one that fits.
    total, _ = _pour(fleet, r, left, fleet.power[r])
    most, _ = _pour(fleet, r, right, fleet.other)
    if most > total:
        share = min(max((budget - total) / (most - total), 0.0), 1.0)
        for m in range(slots):
            fleet.power[r, m] += share * (fleet.other[m] - fleet.power[r, m])
    return left


@inner
def _pour(fleet: Fleet, r: int, level: float, power: Array) -> tuple[float, float]:
    """Set all powers for a level; return their sum over slots 1.. and its slope in the level."""
    total, slope = 0.0, 0.0
    slots = power.shape[0]
    for m in range(slots):
        rate = 0.0
        begin, end = fleet.start[r * slots + m], fleet.start[r * slots + m + 1]
        if begin == end or level <= fleet.at_low[m]:
            power[m] = fleet.low[r, m]
        elif level >= fleet.at_high[m]:
            power[m] = fleet.high[r, m]
        else:
            power[m], rate = _climb(fleet, r, m, level)
        if m > 0:
            total += power[m]
            slope += rate
    return total, slope


@inner
def _climb(fleet: Fleet, r: int, m: int, level: float) -> tuple[float, float]:
    """Power p of slot m with G(p) = level, and dp/dlevel."""
    low, high = fleet.low[r, m], fleet.high[r, m]
    slot = r * fleet.mean.shape[0] + m
    begin, end = fleet.start[slot], fleet.start[slot + 1]
    # A harmonic mean is at most the arithmetic one, so this start lies left of the root.
    p = min(max(low, (end - begin) * level - fleet.mean[m]), high)
    rate = 0.0
    for _ in range(INNER_STEPS):
        first, second = 0.0, 0.0
        for k in range(begin, end):
            inverse = 1.0 / (p + fleet.terms[k])
            first += inverse
            second += inverse * inverse
        rate = first * first / second
        step = (level - 1.0 / first) * rate
        following = min(max(p + step, low), high)
        if abs(following - p) <= 1e-15 * following or following == p:
            return following, rate
        if step < 0.0:
            # Past the root by rounding only: nothing left to gain.
            return p, rate
        p = following
    return p, rate


@inner
def _level_at(terms: Array, begin: int, end: int, p: float) -> float:
    """G(p), the level at which a slot takes the power p; its s are terms[begin:end]."""
    first = 0.0
    for k in range(begin, end):
        first += 1.0 / (p + terms[k])
    return 1.0 / first
