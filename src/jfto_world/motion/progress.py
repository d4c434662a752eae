"""How far along its trajectory a UAV really is."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

# Of places about equally near, the one nearest to the expected time is meant: metres per second.
_TIE_M_PER_S = 1e-3


def progress_time(
    times_s: Array, positions_m: Array, measured_m: Array, expected_s: float, window_s: float
) -> float:
    """Time on a trajectory at which it passes nearest to a measured position.

    `times_s` (M,) grows and `positions_m` is (M, 3), taken as straight in between; `measured_m` is
    (3,). Only times within `window_s` of `expected_s` are considered, so that a route which comes
    back to a place is not mistaken for having been there before.
    """
    low = min(max(expected_s - window_s, times_s[0]), times_s[-1])
    high = max(min(expected_s + window_s, times_s[-1]), times_s[0])
    inside = (times_s > low) & (times_s < high)
    times = np.concatenate([[low], times_s[inside], [high]])
    points = sample(times_s, positions_m, times)
    step, start = np.diff(points, axis=0), points[:-1]
    length_2 = np.einsum("ij,ij->i", step, step)
    along = np.einsum("ij,ij->i", measured_m - start, step)
    share = np.divide(along, length_2, out=np.zeros_like(along), where=length_2 > 0)
    share = np.clip(share, 0.0, 1.0)
    # Where the UAV holds, every time is as near; the expected one is the best guess.
    held = length_2 == 0
    span = np.diff(times)
    share[held] = np.clip((expected_s - times[:-1]) / np.maximum(span, 1e-9), 0.0, 1.0)[held]
    candidate = times[:-1] + share * span
    away = np.linalg.norm(start + share[:, None] * step - measured_m, axis=1)
    return float(candidate[np.argmin(away + _TIE_M_PER_S * np.abs(candidate - expected_s))])


def sample(times_s: Array, positions_m: Array, at_s: Array) -> Array:
    """Positions (T, 3) at the given times; before the first and after the last, those hold."""
    return np.stack([np.interp(at_s, times_s, positions_m[:, axis]) for axis in range(3)], axis=-1)
