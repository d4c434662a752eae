"""A streamed curve along straight legs that stops at each of its points."""

from __future__ import annotations

import itertools
import math

import numpy as np

from jfto_msgs_py.types import Array
from jfto_planner.smoothing.limits import GRAVITY_MPS2, CurveLimits
from jfto_planner.smoothing.trajectory import Trajectory

# Of every limit, so that rounding in a plan file breaks none.
SHARE = 0.995
# Control points of speeding up from rest, of the speed reached times the time it takes.
_RISE = np.array([0.0, 0.0, 0.0, 0.1, 0.3, 0.5])
_SHORTEST_M = 1e-6


def stopping_curve(points_m: Array, limits: CurveLimits) -> Trajectory:
    """Quintic segments along points (K, 3), K at least 2, at rest at each of them.

    Each leg speeds up by v (3 s² - 2 s³), cruises and slows down alike: speed, acceleration and
    jerk keep to `limits`, all of them are continuous but the jerk.
    """
    control, duration, passed = [], [], [0.0]
    for begin, end in itertools.pairwise(points_m):
        length = float(np.linalg.norm(end - begin))
        unit = (end - begin) / length
        speed, accel = _along(unit, limits)
        jerk = SHARE * limits.jerk_mps3
        speed = min(speed, math.sqrt(length * accel / 1.5), (length**2 * jerk / 6.0) ** (1 / 3))
        rise_s = max(1.5 * speed / accel, math.sqrt(6.0 * speed / jerk))
        rise_m = 0.5 * speed * rise_s
        along = [(rise_s, speed * rise_s * _RISE)]
        steady_m = length - 2.0 * rise_m
        if steady_m > _SHORTEST_M:
            along.append((steady_m / speed, rise_m + steady_m * np.arange(6) / 5.0))
        along.append((rise_s, length - speed * rise_s * _RISE[::-1]))
        for span_s, distance in along:
            control.append(begin + distance[:, None] * unit)
            duration.append(span_s)
        passed.append(passed[-1] + sum(span_s for span_s, _ in along))
    return Trajectory(np.array(control), np.array(duration), np.array(passed))


def _along(unit: Array, limits: CurveLimits) -> tuple[float, float]:
    """Greatest speed and acceleration along a direction (3,)."""
    level, rise = math.hypot(unit[0], unit[1]), abs(float(unit[2]))
    vertical = limits.climb_mps if unit[2] > 0 else limits.descent_mps
    speed = min(
        limits.speed_mps / level if level > 1e-9 else math.inf,
        vertical / rise if rise > 1e-9 else math.inf,
    )
    lean = math.tan(math.radians(limits.tilt_deg))
    drag = limits.drag_1ps * speed
    accel = min(
        limits.accel_mps2 / level if level > 1e-9 else math.inf,
        limits.accel_z_mps2 / rise if rise > 1e-9 else math.inf,
        (lean * (GRAVITY_MPS2 - drag * rise) - drag * level) / (level + lean * rise),
    )
    return SHARE * speed, SHARE * accel
