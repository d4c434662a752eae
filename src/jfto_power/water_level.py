"""Exact power allocation of one UAV: one water level, found by Newton steps on both floors.

A UAV's share of (P4) is: maximise Σ_n Σ_b ln(1 + p_n / s_nb) subject to low ≤ p_n ≤ high and
Σ_n p_n ≤ budget, where s = σ²B / h is the power that would arrive at 0 dB over the noise. With the
multiplier λ = 1/u of the budget, the best p_n solves G_n(p) = u, clipped to its interval, where
G_n(p) = 1 / Σ_b 1/(p + s_nb). G_n is increasing and concave, almost a straight line, so Newton's
method from the left climbs to p_n(u) without ever passing it, in two to four steps; Σ_n p_n(u) is
increasing in u, so a second, bracketed Newton finds the level that spends the budget.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from jfto_msgs_py.types import Array
from jfto_world.compiled import allocating_kernel as kernel

OUTER_STEPS = 200
INNER_STEPS = 60
# Share of the budget that may be left over, by rounding alone.
CLOSE = 1e-14


@kernel
def fill_rows(
    linked: NDArray[np.bool_],
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
    slots, rows, others = linked.shape
    power = low_w.copy()
    level = np.empty(rows)
    for row in range(rows):
        start = np.zeros(slots + 1, dtype=np.int64)
        s_w = np.empty(slots * others)
        for m in range(slots):
            stop = start[m]
            for b in range(others):
                if linked[m, row, b] and gain[m, row, b] > 0.0:
                    s_w[stop] = noise_w / gain[m, row, b]
                    stop += 1
            start[m + 1] = stop
        level[row] = _fill(
            s_w,
            start,
            np.ascontiguousarray(low_w[:, row]),
            np.ascontiguousarray(high_w[:, row]),
            budget_w[row],
            power[:, row],
        )
    return power, level


@kernel
def _fill(
    s_w: Array, start: NDArray, low: Array, high: Array, budget: float, power: Array
) -> float:
    """Write the best powers of one UAV and return its water level."""
    slots = low.shape[0]
    at_low, at_high, mean = np.empty(slots), np.empty(slots), np.empty(slots)
    left, right, most = np.inf, 0.0, 0.0
    for m in range(slots):
        terms = s_w[start[m] : start[m + 1]]
        if terms.size == 0:
            # No rate to gain: the level never lifts the power off its floor.
            at_low[m], at_high[m], mean[m] = np.inf, np.inf, 0.0
        else:
            at_low[m], at_high[m] = _level_at(terms, low[m]), _level_at(terms, high[m])
            mean[m] = terms.mean()
        if m > 0:
            most += low[m] if terms.size == 0 else high[m]
            if terms.size > 0:
                left, right = min(left, at_low[m]), max(right, at_high[m])
    if most <= budget:
        _pour(s_w, start, low, high, at_low, at_high, mean, np.inf, power)
        return np.inf
    return _search(s_w, start, low, high, at_low, at_high, mean, budget, left, right, power)


@kernel
def _search(
    s_w: Array,
    start: NDArray,
    low: Array,
    high: Array,
    at_low: Array,
    at_high: Array,
    mean: Array,
    budget: float,
    left: float,
    right: float,
    power: Array,
) -> float:
    """Level between `left` and `right` that spends the budget; leaves the powers in `power`."""
    total, _ = _pour(s_w, start, low, high, at_low, at_high, mean, left, power)
    if budget - total <= CLOSE * budget:
        return left
    # Exact where every slot is linked, off its bounds and has equal gains: a good first guess.
    level = (budget + mean[1:].sum()) / (start[-1] - start[1])
    if not left < level < right:
        level = left + 0.5 * (right - left)
    for step in range(OUTER_STEPS):
        total, slope = _pour(s_w, start, low, high, at_low, at_high, mean, level, power)
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
    total, _ = _pour(s_w, start, low, high, at_low, at_high, mean, left, power)
    ahead = power.copy()
    most, _ = _pour(s_w, start, low, high, at_low, at_high, mean, right, ahead)
    if most > total:
        share = min(max((budget - total) / (most - total), 0.0), 1.0)
        for m in range(power.shape[0]):
            power[m] += share * (ahead[m] - power[m])
    return left


@kernel
def _pour(
    s_w: Array,
    start: NDArray,
    low: Array,
    high: Array,
    at_low: Array,
    at_high: Array,
    mean: Array,
    level: float,
    power: Array,
) -> tuple[float, float]:
    """Set all powers for a level; return their sum over slots 1.. and its slope in the level."""
    total, slope = 0.0, 0.0
    for m in range(power.shape[0]):
        rate = 0.0
        if start[m] == start[m + 1] or level <= at_low[m]:
            power[m] = low[m]
        elif level >= at_high[m]:
            power[m] = high[m]
        else:
            terms = s_w[start[m] : start[m + 1]]
            power[m], rate = _climb(terms, mean[m], level, low[m], high[m])
        if m > 0:
            total += power[m]
            slope += rate
    return total, slope


@kernel
def _climb(terms: Array, mean: float, level: float, low: float, high: float) -> tuple[float, float]:
    """Power p with G(p) = level, and dp/dlevel."""
    # A harmonic mean is at most the arithmetic one, so this start lies left of the root.
    p = min(max(low, terms.size * level - mean), high)
    rate = 0.0
    for _ in range(INNER_STEPS):
        first, second = 0.0, 0.0
        for s in terms:
            inverse = 1.0 / (p + s)
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


@kernel
def _level_at(terms: Array, p: float) -> float:
    """G(p), the level at which a slot takes the power p."""
    first = 0.0
    for s in terms:
        first += 1.0 / (p + s)
    return 1.0 / first
