"""Times to compare a trajectory with."""

from __future__ import annotations

import math

import numpy as np

from jfto_msgs_py.types import Array
from jfto_planner.smoothing.limits import CurveLimits


def rest_to_rest_s(length_m: float, speed_mps: float, accel_mps2: float, jerk_mps3: float) -> float:
    """Least duration of one quintic segment from rest to rest along a straight line.

    T = max(1.875 L/v, sqrt(10/sqrt(3) L/a), (60 L/j)^(1/3)): the position 10 s³ - 15 s⁴ + 6 s⁵ has
    these peaks of speed, acceleration and jerk.
    """
    return max(
        1.875 * length_m / speed_mps,
        math.sqrt(10.0 / math.sqrt(3.0) * length_m / accel_mps2),
        (60.0 * length_m / jerk_mps3) ** (1.0 / 3.0),
    )


def straight_line_s(points_m: Array, limits: CurveLimits) -> float:
    """Lower bound of any trajectory through the points: straight legs at full speed."""
    step = np.diff(np.asarray(points_m, dtype=np.float64), axis=0)
    rise = step[:, 2]
    vertical = np.where(rise > 0, rise / limits.climb_mps, -rise / limits.descent_mps)
    level = np.hypot(step[:, 0], step[:, 1]) / limits.speed_mps
    return float(np.sum(np.maximum(level, vertical)))
