"""The waypoint planner, compiled: S-curve legs, corner overlaps, the target along a route.

Each leg is a jerk-limited S-curve from rest to rest, worked out here from its definition
(raised-cosine jerk ramps of length t_j, constant jerk t_2, constant acceleration t_4); at a
fly-through waypoint the end of one leg and the start of the next are flown at once. A leg is a row
of 14 numbers whose columns the constants name.
"""

from __future__ import annotations

import math

import numpy as np

from jfto_msgs_py.types import Array, Flags, Ints
from jfto_world.compiled import inner, kernel
from jfto_world.motion.arducopter.wpnav import WpNav

UX, UY, UZ = 0, 1, 2  # unit vector of the leg
LENGTH, SPEED, LIMIT = 3, 4, 5  # m; speed reached; slope-limited speed
ACCEL, JERK = 6, 7  # greatest acceleration and jerk reached
T_J, T_2, T_4 = 8, 9, 10  # jerk ramp, constant jerk, constant acceleration, s
T_ACC, DURATION, HORIZONTAL = 11, 12, 13  # speed-up time, leg time, horizontal share
COLUMNS = 14

_COARSE_S = 0.02
_TYPICAL_COS, _TYPICAL_SIN = math.cos(math.radians(105.0)), math.sin(math.radians(105.0))


def planner_limits(wpnav: WpNav) -> Array:
    """The planner's parameters as the row of 9 numbers that the compiled functions take."""
    return np.array(
        [
            wpnav.speed_mps,
            wpnav.speed_up_mps,
            wpnav.speed_dn_mps,
            wpnav.accel_mps2,
            wpnav.accel_z_mps2,
            wpnav.jerk_mps3,
            2.0 * wpnav.input_tc_s,
            wpnav.radius_m,
            wpnav.corner_limit_mps2,
        ]
    )


@kernel
def solve_speed_up(
    speed: float, accel: float, jerk: float, ramp_s: float, length: float
) -> tuple[float, float, float, float, float, float]:
    """Fastest speed-up from rest that leaves room to brake within `length` metres.

    Returns (speed reached, acceleration, jerk, t_j, t_2, t_4). The acceleration A is the least of
    the limit, the root of A (A/J + t_j) = v and that of A (A/J + t_j)² = L/2; where it is too
    small for a full jerk ramp, the ramp shortens in proportion to the jerk (constant snap).
    """
    half_m = 0.5 * length
    root_v = 0.5 * jerk * (math.sqrt(ramp_s * ramp_s + 4.0 * speed / jerk) - ramp_s)
    peak = min(accel, root_v)
    if peak * (peak / jerk + ramp_s) ** 2 > half_m:
        low, high = 0.0, peak
        for _ in range(60):
            peak = 0.5 * (low + high)
            if peak * (peak / jerk + ramp_s) ** 2 > half_m:
                high = peak
            else:
                low = peak
    if peak < jerk * ramp_s:
        snap = jerk / ramp_s
        ramp_s = min(
            ramp_s,
            (speed / (2.0 * snap)) ** (1.0 / 3.0),
            (half_m / (4.0 * snap)) ** 0.25,
            math.sqrt(accel / snap),
        )
        jerk = snap * ramp_s
        peak = jerk * ramp_s
    jerk_s = peak / jerk + ramp_s
    # constant acceleration until the speed, or half of the leg, is reached
    by_speed = (speed - peak * jerk_s) / peak
    # with T_acc = 2 jerk_s + t4 and v = peak (jerk_s + t4): v T_acc / 2 = L / 2
    by_length = 0.5 * (math.sqrt(jerk_s * jerk_s + 8.0 * half_m / peak) - 3.0 * jerk_s)
    t_4 = max(0.0, min(by_speed, by_length))
    return peak * (jerk_s + t_4), peak, jerk, ramp_s, jerk_s - 2.0 * ramp_s, t_4


@kernel
def fill_leg(leg: Array, dx: float, dy: float, dz: float, limits: Array) -> None:
    """Write the row of the leg (dx, dy, dz) metres into `leg`; a leg of no length lasts 0 s."""
    length = math.sqrt(dx * dx + dy * dy + dz * dz)
    leg[:] = 0.0
    if length < 1e-9:
        return
    level = math.sqrt(dx * dx + dy * dy) / length
    rise = abs(dz) / length
    speed, accel = np.inf, np.inf
    if level > 0.0:
        speed, accel = limits[0] / level, limits[3] / level
    if rise > 0.0:
        speed = min(speed, (limits[1] if dz > 0.0 else limits[2]) / rise)
        accel = min(accel, limits[4] / rise)
    reached, peak, jerk, t_j, t_2, t_4 = solve_speed_up(speed, accel, limits[5], limits[6], length)
    t_acc = 4.0 * t_j + 2.0 * t_2 + t_4
    leg[UX], leg[UY], leg[UZ] = dx / length, dy / length, dz / length
    leg[LENGTH], leg[SPEED], leg[LIMIT] = length, reached, speed
    leg[ACCEL], leg[JERK], leg[T_J], leg[T_2], leg[T_4] = peak, jerk, t_j, t_2, t_4
    leg[T_ACC], leg[HORIZONTAL] = t_acc, level
    leg[DURATION] = t_acc + length / reached


@inner
def _rise(leg: Array, time_s: float) -> tuple[float, float, float]:
    """Distance, speed and acceleration in the first half of the speed-up."""
    t_j, jerk = leg[T_J], leg[JERK]
    beta, half = math.pi / t_j, 0.5 * jerk
    if time_s <= t_j:
        s, c = math.sin(beta * time_s), math.cos(beta * time_s)
        return (
            half * (time_s**3 / 6.0 - time_s / beta**2 + s / beta**3),
            half * (time_s * time_s / 2.0 + (c - 1.0) / beta**2),
            half * (time_s - s / beta),
        )
    x = half * (t_j**3 / 6.0 - t_j / beta**2)
    w = half * (t_j * t_j / 2.0 - 2.0 / beta**2)
    a = half * t_j
    tau = min(time_s - t_j, leg[T_2])
    x += tau * (w + tau * (a / 2.0 + tau * jerk / 6.0))
    w += tau * (a + tau * jerk / 2.0)
    a += tau * jerk
    tau = time_s - t_j - leg[T_2]
    if tau <= 0.0:
        return x, w, a
    ramp = min(tau, t_j)
    s, c = math.sin(beta * ramp), math.cos(beta * ramp)
    x += w * ramp + a * ramp * ramp / 2.0
    x += half * (ramp**3 / 6.0 + ramp / beta**2 - s / beta**3)
    w += a * ramp + half * (ramp * ramp / 2.0 + (1.0 - c) / beta**2)
    a += half * (ramp + s / beta)
    tau -= ramp
    if tau > 0.0:
        x += tau * (w + tau * a / 2.0)
        w += tau * a
    return x, w, a


@kernel
def speed_up(leg: Array, time_s: float) -> tuple[float, float, float]:
    """Distance, speed and acceleration `time_s` after leaving rest, cruising once at speed."""
    t_acc = leg[T_ACC]
    if time_s <= 0.0 or t_acc <= 0.0:
        return 0.0, 0.0, 0.0
    if time_s >= t_acc:
        return leg[SPEED] * (time_s - 0.5 * t_acc), leg[SPEED], 0.0
    if time_s <= 0.5 * t_acc:
        return _rise(leg, time_s)
    # the speed-up is point-symmetric about its middle
    x, w, a = _rise(leg, t_acc - time_s)
    return leg[SPEED] * (time_s - 0.5 * t_acc) + x, leg[SPEED] - w, a


@inner
def along_leg(leg: Array, time_s: float) -> tuple[float, float, float]:
    """Distance, speed and acceleration `time_s` after the leg began; at rest at its end."""
    if time_s >= leg[DURATION]:
        return leg[LENGTH], 0.0, 0.0
    if time_s <= 0.5 * leg[DURATION]:
        return speed_up(leg, time_s)
    x, w, a = speed_up(leg, leg[DURATION] - time_s)
    return leg[LENGTH] - x, w, -a


@inner
def _may_turn(this: Array, after: Array, half_s: float, radius: float, accel: float) -> bool:
    """Whether the autopilot would begin the turn `half_s` before and end it after the corner."""
    x1, w1, c1 = speed_up(this, half_s)
    x2, w2, c2 = speed_up(after, half_s)
    dx = x2 * after[UX] - x1 * this[UX]
    dy = x2 * after[UY] - x1 * this[UY]
    dz = x2 * after[UZ] - x1 * this[UZ]
    if math.sqrt(dx * dx + dy * dy + dz * dz) >= radius:
        return False
    vx = w2 * after[UX] + w1 * this[UX]
    vy = w2 * after[UY] + w1 * this[UY]
    if math.sqrt(vx * vx + vy * vy) >= min(this[SPEED], after[SPEED]):
        return False
    ax = c2 * after[UX] - c1 * this[UX]
    ay = c2 * after[UY] - c1 * this[UY]
    return math.sqrt(ax * ax + ay * ay) < accel


@kernel
def half_overlap_s(this: Array, after: Array, limits: Array) -> float:
    """Half of the time m during which both legs move the target at a fly-through waypoint.

    The largest m for which the two parts, m seconds from rest, stay within the waypoint radius,
    below the slower leg's speed (horizontal) and within the corner acceleration (horizontal), and
    which is at most half of either leg and of T_acc plus the next leg's time to the end of
    constant acceleration. Rows of `leg_profile`; 0 where a leg has no length.
    """
    if this[DURATION] <= 0.0 or after[DURATION] <= 0.0:
        return 0.0
    turn_in = 0.5 * (after[T_ACC] + after[T_4])
    bound = 0.5 * min(this[T_ACC] + turn_in, this[DURATION], after[DURATION])
    radius, accel = limits[7], limits[8]
    if _may_turn(this, after, bound, radius, accel):
        return bound
    # not monotone in m (accelerations rise and fall), hence a scan from above, then a bisection
    high, low = bound, bound
    while low > 0.0:
        low = max(0.0, low - _COARSE_S)
        if _may_turn(this, after, low, radius, accel):
            break
        high = low
    if low <= 0.0:
        return 0.0
    for _ in range(20):
        middle = 0.5 * (low + high)
        if _may_turn(this, after, middle, radius, accel):
            low = middle
        else:
            high = middle
    return low


@kernel
def plan_legs(
    points: Array,
    limits: Array,
    stop: Flags,
    hold_s: Array,
    legs: Array,
    times_s: Array,
) -> None:
    """Fill the legs of a route and their times; arguments as the fields of `TargetTrack`.

    `times_s` (3, M) takes `begin_s`, whose last is of no leg, `half_overlap_s` and `reached_s`.
    """
    count = len(legs)
    begin_s, half_s, reached_s = times_s[0], times_s[1], times_s[2]
    for k in range(count):
        _fill_between(legs[k], points, k, k + 1, limits)
    now = 0.0
    for k in range(count):
        begin_s[k] = now
        if k + 1 < count and not stop[k + 1]:
            half_s[k + 1] = half_overlap_s(legs[k], legs[k + 1], limits)
        now += legs[k, DURATION] - half_s[k + 1]
        reached_s[k + 1] = now + hold_s[k + 1]
        now += hold_s[k + 1] - half_s[k + 1]


@inner
def _fill_between(leg: Array, points: Array, i: int, j: int, limits: Array) -> None:
    """Write the row of the leg from point i to point j into `leg`."""
    dx, dy, dz = (
        points[j, 0] - points[i, 0],
        points[j, 1] - points[i, 1],
        points[j, 2] - points[i, 2],
    )
    fill_leg(leg, dx, dy, dz, limits)


@kernel
def sample_target(
    points: Array, legs: Array, begin_s: Array, times_s: Array, last: Ints, out: Array
) -> None:
    """Add position, velocity and acceleration at `times_s` to `out` (T, 3, 3).

    `last` (T,) is the leg that had begun last by then, -1 before the first.
    """
    count = len(legs)
    for i in range(len(times_s)):
        now = times_s[i]
        first = max(last[i], 0)
        while first > 0 and now < begin_s[first - 1] + legs[first - 1, DURATION]:
            first -= 1
        for axis in range(3):
            out[i, 0, axis] = points[first, axis]
        for k in range(first, min(last[i] + 1, count)):
            x, w, a = along_leg(legs[k], now - begin_s[k])
            for axis in range(3):
                unit = legs[k, UX + axis]
                out[i, 0, axis] += x * unit
                out[i, 1, axis] += w * unit
                out[i, 2, axis] += a * unit


@kernel
def fill_leg_times(points: Array, limits: Array, stops: bool, room: Array, out: Array) -> None:
    """Write the time between each ordered pair of points into `out` (M, M).

    With `stops` rest to rest; without, less the overlap of a corner of 105° between equal legs at
    each end. `room` (2, COLUMNS) is room to work in.
    """
    for i in range(len(points)):
        for j in range(len(points)):
            out[i, j] = _leg_time(points, i, j, limits, stops, room)


@kernel
def fill_chain_times(points: Array, limits: Array, stops: bool, room: Array, out: Array) -> None:
    """The same from each point to the next, into `out` (M - 1,)."""
    for i in range(len(out)):
        out[i] = _leg_time(points, i, i + 1, limits, stops, room)


@inner
def _leg_time(points: Array, i: int, j: int, limits: Array, stops: bool, room: Array) -> float:
    leg, turned = room[0], room[1]
    _fill_between(leg, points, i, j, limits)
    if stops or i == j:
        return leg[DURATION]
    for k in range(COLUMNS):
        turned[k] = leg[k]
    turned[UX] = _TYPICAL_COS * leg[UX] - _TYPICAL_SIN * leg[UY]
    turned[UY] = _TYPICAL_SIN * leg[UX] + _TYPICAL_COS * leg[UY]
    return leg[DURATION] - 2.0 * half_overlap_s(leg, turned, limits)
