"""Quintic Bezier segments, compiled.

A segment is fixed by position, velocity and acceleration at both ends and its duration T: its six
control points are P1 = P0 + T v0/5, P2 = P0 + 2 T v0/5 + T² a0/20, mirrored at the other end.
"""

from __future__ import annotations

import math

import numpy as np

from jfto_msgs_py.types import Array
from jfto_msgs_py.units import GRAVITY_MPS2
from jfto_world.compiled import inner, kernel

# columns of a limits row
SPEED, CLIMB, DESCENT, ACCEL, ACCEL_Z, JERK, TILT_TAN, DRAG = 0, 1, 2, 3, 4, 5, 6, 7

SCAN = 1.02  # step of the scan over durations


@kernel
def control_points(start: Array, end: Array, duration_s: float, out: Array) -> None:
    """Write the control points (6, 3) between two states (3, 3): rows p, v, a."""
    t = duration_s
    for k in range(3):
        out[0, k] = start[0, k]
        out[1, k] = start[0, k] + t * start[1, k] / 5.0
        out[2, k] = start[0, k] + 2.0 * t * start[1, k] / 5.0 + t * t * start[2, k] / 20.0
        out[3, k] = end[0, k] - 2.0 * t * end[1, k] / 5.0 + t * t * end[2, k] / 20.0
        out[4, k] = end[0, k] - t * end[1, k] / 5.0
        out[5, k] = end[0, k]


@inner
def _ratio(vx: float, vy: float, vz: float, ax: float, ay: float, az: float, lim: Array) -> float:
    """Largest squared ratio of speed, acceleration and tilt to their limits at one instant."""
    worst = (vx * vx + vy * vy) / (lim[SPEED] * lim[SPEED])
    rise = vz / lim[CLIMB] if vz > 0.0 else vz / lim[DESCENT]
    worst = max(worst, rise * rise)
    worst = max(worst, (ax * ax + ay * ay) / (lim[ACCEL] * lim[ACCEL]))
    worst = max(worst, az * az / (lim[ACCEL_Z] * lim[ACCEL_Z]))
    tx, ty = ax + lim[DRAG] * vx, ay + lim[DRAG] * vy
    up = lim[TILT_TAN] * max(GRAVITY_MPS2 + az + lim[DRAG] * vz, 1e-3)
    return max(worst, (tx * tx + ty * ty) / (up * up))


@inner
def _velocity(points: Array, k: int, duration_s: float) -> tuple[float, float, float, float, float]:
    """Velocity along axis k in the power basis of s = t / T."""
    r1 = 1.0 / duration_s
    p0, p1, p2 = points[0, k], points[1, k], points[2, k]
    p3, p4, p5 = points[3, k], points[4, k], points[5, k]
    return (
        5.0 * r1 * (p1 - p0),
        20.0 * r1 * (p0 - 2.0 * p1 + p2),
        30.0 * r1 * (p3 - p0 + 3.0 * (p1 - p2)),
        20.0 * r1 * (p0 + p4 - 4.0 * (p1 + p3) + 6.0 * p2),
        5.0 * r1 * (p5 - p0 + 5.0 * (p1 - p4) + 10.0 * (p3 - p2)),
    )


@inner
def _motion(
    c: tuple[float, float, float, float, float], s: float, r1: float
) -> tuple[float, float, float]:
    """Velocity, acceleration and jerk along an axis at s, `c` as of `_velocity`, r1 = 1 / T."""
    c0, c1, c2, c3, c4 = c
    return (
        c0 + s * (c1 + s * (c2 + s * (c3 + s * c4))),
        r1 * (c1 + s * (2.0 * c2 + s * (3.0 * c3 + s * 4.0 * c4))),
        r1 * r1 * (2.0 * c2 + s * (6.0 * c3 + s * 12.0 * c4)),
    )


@inner
def sampled_excess(
    points: Array, duration_s: float, lim: Array, samples: int, stop_above: float
) -> float:
    """Largest ratio of any quantity to its limit over `samples` + 1 instants of a segment.

    Returns early, with a value above `stop_above`, once that is exceeded.
    """
    x, y, z = (
        _velocity(points, 0, duration_s),
        _velocity(points, 1, duration_s),
        _velocity(points, 2, duration_s),
    )
    r1 = 1.0 / duration_s
    worst = 0.0
    stop = stop_above * stop_above
    for i in range(samples + 1):
        s = i / samples
        vx, ax, jx = _motion(x, s, r1)
        vy, ay, jy = _motion(y, s, r1)
        vz, az, jz = _motion(z, s, r1)
        jerk = jx**2 + jy**2 + jz**2
        worst = max(worst, jerk / (lim[JERK] * lim[JERK]))
        worst = max(worst, _ratio(vx, vy, vz, ax, ay, az, lim))
        if worst > stop:
            break
    return math.sqrt(worst)


@inner
def _pulls(
    before: Array, after: Array, vertex: Array, k: int, t_b: float, t_a: float
) -> tuple[float, float]:
    """Gradient of the squared jerk of both segments in the vertex' velocity and acceleration."""
    kb, ka = 60.0 / t_b**3, 60.0 / t_a**3
    p0, p5 = before[0, k] - vertex[0, k], after[0, k] - vertex[0, k]
    p1 = p0 + 0.2 * t_b * before[1, k]
    p2 = p0 + 0.4 * t_b * before[1, k] + t_b * t_b * before[2, k] / 20.0
    p4 = p5 - 0.2 * t_a * after[1, k]
    p3 = p5 - 0.4 * t_a * after[1, k] + t_a * t_a * after[2, k] / 20.0
    g1 = 2.0 / t_b * kb * (4.0 * p2 - p1) + 2.0 / t_a * ka * (p4 - 4.0 * p3)
    return g1, -kb * p2 - ka * p3


@inner
def fill_vertex(
    before: Array, after: Array, vertex: Array, t_b: float, t_a: float, cap: float
) -> None:
    """Velocity and acceleration at a waypoint that minimise the squared jerk of both segments.

    The inner, convex problem: quadratic in the six unknowns and separate for each axis, hence a
    2 x 2 system in closed form. `before` and `after` are the outer states; rows 1 and 2 of
    `vertex` are filled. Where the speed would exceed `cap` it is cut, the acceleration solved anew.
    """
    h11 = 192.0 * (1.0 / t_b**3 + 1.0 / t_a**3)
    h12 = 36.0 * (1.0 / t_a**2 - 1.0 / t_b**2)
    h22 = 9.0 * (1.0 / t_b + 1.0 / t_a)
    det = h11 * h22 - h12 * h12
    size = 0.0
    for k in range(3):
        g1, g2 = _pulls(before, after, vertex, k, t_b, t_a)
        vertex[1, k] = (g2 * h12 - g1 * h22) / det
        vertex[2, k] = (g1 * h12 - g2 * h11) / det
        size += vertex[1, k] ** 2
    size = math.sqrt(size)
    if size > cap:
        for k in range(3):
            _, g2 = _pulls(before, after, vertex, k, t_b, t_a)
            vertex[1, k] *= cap / size
            vertex[2, k] = -(g2 + h12 * vertex[1, k]) / h22


@inner
def _fits(start: Array, end: Array, duration_s: float, lim: Array, samples: int, p: Array) -> bool:
    control_points(start, end, duration_s, p)
    return sampled_excess(p, duration_s, lim, samples, 1.0) <= 1.0


@inner
def least_duration(
    start: Array, end: Array, top_s: float, lim: Array, samples: int, p: Array
) -> float:
    """Shortest duration up to `top_s` of a segment between two states in the limits; inf if none.

    The durations that fit need not be all above the shortest, hence a scan, then a bisection. `p`
    (6, 3) is room for control points.
    """
    dx, dy, dz = end[0, 0] - start[0, 0], end[0, 1] - start[0, 1], end[0, 2] - start[0, 2]
    low = max(math.sqrt(dx * dx + dy * dy) / lim[SPEED], dz / lim[CLIMB], -dz / lim[DESCENT], 1e-3)
    low *= 0.99
    high = low
    while not _fits(start, end, high, lim, samples, p):
        if high >= top_s:
            return np.inf
        low, high = high, min(high * SCAN, top_s)
    while high - low > 1e-6 * high:
        middle = 0.5 * (low + high)
        if _fits(start, end, middle, lim, samples, p):
            high = middle
        else:
            low = middle
    return high
