"""How far along its trajectory a UAV really is."""

from __future__ import annotations

import numpy as np

from jfto_msgs_py.types import Array
from jfto_world.compiled import inner, kernel


def progress_time(
    times_s: Array,
    positions_m: Array,
    measured_m: Array,
    expected_s: float,
    low_s: float,
    high_s: float,
    pull_mps: float,
) -> tuple[float, float]:
    """Time on a trajectory at which a UAV measured at a place most likely is, and how far off.

    `times_s` (M,) grows and `positions_m` is (M, 3), taken as straight in between; `measured_m` is
    (3,). Found is the least of distance² + (pull_mps × time from expected_s)² from `low_s` to
    `high_s`: a second off the expected time weighs as much as `pull_mps` metres off the line.
    So a route that crosses itself is not mistaken for having been there before, and where the
    trajectory holds the expected time is the answer. The distance is that to the place alone, m.
    """
    low = min(max(low_s, times_s[0]), times_s[-1])
    high = max(min(high_s, times_s[-1]), times_s[0])
    first = int(np.searchsorted(times_s, low, side="right")) - 1
    first = min(max(first, 0), max(len(times_s) - 2, 0))
    return _best_time(times_s, positions_m, measured_m, expected_s, (low, high), pull_mps, first)


@kernel
def _best_time(
    times_s: Array,
    positions_m: Array,
    measured_m: Array,
    expected_s: float,
    window_s: tuple[float, float],
    pull_mps: float,
    first: int,
) -> tuple[float, float]:
    """The same from piece `first` on."""
    last = times_s.shape[0] - 1
    found, found_away, least = window_s[0], np.inf, np.inf
    for m in range(first, max(last, 1)):
        begin, end = times_s[m], times_s[min(m + 1, last)]
        if begin > window_s[1]:
            break
        ends_m = (positions_m[m], positions_m[min(m + 1, last)])
        time, away_2 = _nearest((begin, end), ends_m, measured_m, expected_s, pull_mps, window_s)
        cost = away_2 + (pull_mps * (time - expected_s)) ** 2
        if cost < least:
            found, found_away, least = time, np.sqrt(away_2), cost
    return found, found_away


def passes(
    times_s: Array, positions_m: Array, measured_m: Array, latest_s: float, within_m: float
) -> Array:
    """Every time up to `latest_s` at which a trajectory passes a place within `within_m` metres.

    One per pass: where the distance is locally least. Arguments as for `progress_time`.
    """
    found = np.empty(len(times_s))
    return found[: _find_passes(times_s, positions_m, measured_m, latest_s, within_m, found)]


@kernel
def _find_passes(
    times_s: Array, positions_m: Array, measured_m: Array, latest_s: float, within_m: float,
    found: Array,
) -> int:  # fmt: skip
    """Write the times of all passes into `found` (M,) and return how many there are."""
    count, number = times_s.shape[0], 0
    before, here_s, here = np.inf, times_s[0], np.inf
    for m in range(count):
        after_s, after = times_s[m], np.inf
        if m + 1 < count and times_s[m] <= latest_s:
            high = min(times_s[m + 1], max(latest_s, times_s[m]))
            begin_s, ends_m = times_s[m], (positions_m[m], positions_m[m + 1])
            after_s, away_2 = _nearest(
                (begin_s, times_s[m + 1]), ends_m, measured_m, begin_s, 0.0, (begin_s, high)
            )
            after = np.sqrt(away_2)
        elif count == 1:
            begin_s, ends_m = times_s[0], (positions_m[0], positions_m[0])
            _, away_2 = _nearest(
                (begin_s, begin_s), ends_m, measured_m, begin_s, 0.0, (begin_s, begin_s)
            )
            after = np.sqrt(away_2)
        if m > 0 and here <= within_m and here <= before and here < after:
            found[number] = here_s
            number += 1
        before, here, here_s = here, after, after_s
    if count == 1 and here <= within_m:
        found[number] = here_s
        number += 1
    return number


@inner
def _nearest(
    ends_s: tuple[float, float],
    ends_m: tuple[Array, Array],
    measured_m: Array,
    expected_s: float,
    pull_mps: float,
    window_s: tuple[float, float],
) -> tuple[float, float]:
    """Best time on one straight piece, within a window, and the distance² there.

    `ends_s` and `ends_m` are when the piece begins and ends, and where.
    """
    (begin_s, end_s), (begin_m, end_m) = ends_s, ends_m
    along, length_2 = 0.0, 0.0
    for axis in range(3):
        step = end_m[axis] - begin_m[axis]
        along += (measured_m[axis] - begin_m[axis]) * step
        length_2 += step * step
    span = end_s - begin_s
    pull_2 = pull_mps * pull_mps
    weight = length_2 + pull_2 * span * span
    share = (along + pull_2 * span * (expected_s - begin_s)) / weight if weight > 0 else 0.0
    time = min(max(begin_s + share * span, begin_s, window_s[0]), end_s, window_s[1])
    share = (time - begin_s) / span if span > 0 else 0.0
    away_2 = 0.0
    for axis in range(3):
        off = begin_m[axis] + share * (end_m[axis] - begin_m[axis]) - measured_m[axis]
        away_2 += off * off
    return time, away_2


def sample(times_s: Array, positions_m: Array, at_s: Array) -> Array:
    """Positions (T, 3) at the given times; before the first and after the last, those hold."""
    return np.stack([np.interp(at_s, times_s, positions_m[:, axis]) for axis in range(3)], axis=-1)
