"""Quintic Bezier segments and the smoothing of one route, compiled.

A segment is fixed by position, velocity and acceleration at both ends and its duration T: its six
control points are P1 = P0 + T v0/5, P2 = P0 + 2 T v0/5 + T² a0/20, mirrored at the other end.
A corner is a pair of segments from cruise on one leg through the waypoint to cruise on the next.
"""

from __future__ import annotations

import math

import numpy as np

from jfto_msgs_py.types import Array, Flags
from jfto_world.compiled import allocating_kernel as kernel

# columns of a limits row
SPEED, CLIMB, DESCENT, ACCEL, ACCEL_Z, JERK, TILT_TAN, DRAG = 0, 1, 2, 3, 4, 5, 6, 7
GRAVITY_MPS2 = 9.80665

_MOVES = np.array(
    [
        [1.0, 0.0, 0.0, 0.0, 0.0],
        [0.0, 1.0, 0.0, 0.0, 0.0],
        [0.0, 0.0, 0.5, 0.0, 0.0],
        [0.0, 0.0, 0.0, 0.5, 0.0],
        [0.0, 0.0, 0.0, 0.0, 0.5],
        [0.0, 0.0, 0.0, 0.4, 0.4],
        [1.0, 1.0, 0.0, 0.0, 0.0],
        [1.0, 1.0, 0.0, 0.4, 0.4],
    ]
)
_SCAN = 1.02  # step of the scan over durations
_PATIENCE = 6.0  # durations are tried up to this many times those at cruise speed


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


@kernel
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


@kernel
def sampled_excess(
    points: Array, duration_s: float, lim: Array, samples: int, stop_above: float
) -> float:
    """Largest ratio of any quantity to its limit over `samples` + 1 instants of a segment.

    Returns early, with a value above `stop_above`, once that is exceeded.
    """
    c = np.empty((3, 5))
    r1 = 1.0 / duration_s
    for k in range(3):  # velocity in the power basis of s = t / T
        p0, p1, p2 = points[0, k], points[1, k], points[2, k]
        p3, p4, p5 = points[3, k], points[4, k], points[5, k]
        c[k, 0] = 5.0 * r1 * (p1 - p0)
        c[k, 1] = 20.0 * r1 * (p0 - 2.0 * p1 + p2)
        c[k, 2] = 30.0 * r1 * (p3 - p0 + 3.0 * (p1 - p2))
        c[k, 3] = 20.0 * r1 * (p0 + p4 - 4.0 * (p1 + p3) + 6.0 * p2)
        c[k, 4] = 5.0 * r1 * (p5 - p0 + 5.0 * (p1 - p4) + 10.0 * (p3 - p2))
    worst = 0.0
    v, a = np.empty(3), np.empty(3)
    stop = stop_above * stop_above
    for i in range(samples + 1):
        s = i / samples
        jerk = 0.0
        for k in range(3):
            c1, c2, c3, c4 = c[k, 1], c[k, 2], c[k, 3], c[k, 4]
            v[k] = c[k, 0] + s * (c1 + s * (c2 + s * (c3 + s * c4)))
            a[k] = r1 * (c1 + s * (2.0 * c2 + s * (3.0 * c3 + s * 4.0 * c4)))
            jerk += (r1 * r1 * (2.0 * c2 + s * (6.0 * c3 + s * 12.0 * c4))) ** 2
        worst = max(worst, jerk / (lim[JERK] * lim[JERK]))
        worst = max(worst, _ratio(v[0], v[1], v[2], a[0], a[1], a[2], lim))
        if worst > stop:
            break
    return math.sqrt(worst)


@kernel
def fill_vertex(
    before: Array, after: Array, vertex: Array, t_b: float, t_a: float, cap: float
) -> None:
    """Velocity and acceleration at a waypoint that minimise the squared jerk of both segments.

    The inner, convex problem: quadratic in the six unknowns and separate for each axis, hence a
    2 x 2 system in closed form. `before` and `after` are the outer states; rows 1 and 2 of
    `vertex` are filled. Where the speed would exceed `cap` it is cut, the acceleration solved anew.
    """
    kb, ka = 60.0 / t_b**3, 60.0 / t_a**3
    h11 = 192.0 * (1.0 / t_b**3 + 1.0 / t_a**3)
    h12 = 36.0 * (1.0 / t_a**2 - 1.0 / t_b**2)
    h22 = 9.0 * (1.0 / t_b + 1.0 / t_a)
    det = h11 * h22 - h12 * h12
    size = 0.0
    g2 = np.empty(3)
    for k in range(3):
        p0, p5 = before[0, k] - vertex[0, k], after[0, k] - vertex[0, k]
        p1 = p0 + 0.2 * t_b * before[1, k]
        p2 = p0 + 0.4 * t_b * before[1, k] + t_b * t_b * before[2, k] / 20.0
        p4 = p5 - 0.2 * t_a * after[1, k]
        p3 = p5 - 0.4 * t_a * after[1, k] + t_a * t_a * after[2, k] / 20.0
        g1 = 2.0 / t_b * kb * (4.0 * p2 - p1) + 2.0 / t_a * ka * (p4 - 4.0 * p3)
        g2[k] = -kb * p2 - ka * p3
        vertex[1, k] = (g2[k] * h12 - g1 * h22) / det
        vertex[2, k] = (g1 * h12 - g2[k] * h11) / det
        size += vertex[1, k] ** 2
    size = math.sqrt(size)
    if size > cap:
        for k in range(3):
            vertex[1, k] *= cap / size
            vertex[2, k] = -(g2[k] + h12 * vertex[1, k]) / h22


@kernel
def _fits(start: Array, end: Array, duration_s: float, lim: Array, samples: int, p: Array) -> bool:
    control_points(start, end, duration_s, p)
    return sampled_excess(p, duration_s, lim, samples, 1.0) <= 1.0


@kernel
def least_duration(start: Array, end: Array, top_s: float, lim: Array, samples: int) -> float:
    """Shortest duration up to `top_s` of a segment between two states in the limits; inf if none.

    The durations that fit need not be all above the shortest, hence a scan, then a bisection.
    """
    p = np.empty((6, 3))
    dx, dy, dz = end[0, 0] - start[0, 0], end[0, 1] - start[0, 1], end[0, 2] - start[0, 2]
    low = max(math.sqrt(dx * dx + dy * dy) / lim[SPEED], dz / lim[CLIMB], -dz / lim[DESCENT], 1e-3)
    low *= 0.99
    high = low
    while not _fits(start, end, high, lim, samples, p):
        if high >= top_s:
            return np.inf
        low, high = high, min(high * _SCAN, top_s)
    while high - low > 1e-6 * high:
        middle = 0.5 * (low + high)
        if _fits(start, end, middle, lim, samples, p):
            high = middle
        else:
            low = middle
    return high


@kernel
def leg_limit(dx: float, dy: float, dz: float, lim: Array) -> float:
    """Greatest speed along a direction that need not have length 1."""
    size = math.sqrt(dx * dx + dy * dy + dz * dz)
    level, rise = math.sqrt(dx * dx + dy * dy) / size, abs(dz) / size
    speed = np.inf
    if level > 0.0:
        speed = lim[SPEED] / level
    if rise > 0.0:
        speed = min(speed, (lim[CLIMB] if dz > 0.0 else lim[DESCENT]) / rise)
    return speed * (1.0 - 1e-9)


@kernel
def _knot(at: Array, far: Array, speed: float, lim: Array, state: Array, sign: float) -> float:
    """Set `state` to cruise at `at`, on the line to `far` (sign 1) or from it (-1); line time."""
    dx, dy, dz = sign * (far[0] - at[0]), sign * (far[1] - at[1]), sign * (far[2] - at[2])
    size = math.sqrt(dx * dx + dy * dy + dz * dz)
    cruise = min(speed, leg_limit(dx, dy, dz, lim))
    state[0, 0], state[0, 1], state[0, 2] = at[0], at[1], at[2]
    state[1, 0], state[1, 1], state[1, 2] = (
        cruise * dx / size,
        cruise * dy / size,
        cruise * dz / size,
    )
    state[2] = 0.0
    return size / cruise


@kernel
def joint_time(
    par: Array, frame: Array, ends: Array, speeds: Array, stop: bool, cap: float, corridor: float,
    lim: Array, samples: int, best: float, states: Array, durations: Array,
) -> float:  # fmt: skip
    """Time from the previous joint's last knot to the next joint's first one; inf if none fits.

    The outer variables `par`: log distance of the knots before and after the waypoint, log of the
    split of time between them, sideways offset of both knots. `frame` (5, 3): waypoint, direction
    of both legs, sideways direction of both knots. `ends` (2, 3): the neighbours' knots. Fills the
    `states` (3, 3, 3) before, at and after the waypoint and the two `durations`. Gives up, with
    inf, where the time would exceed `best`.
    """
    d_b, d_a, split = math.exp(par[0]), math.exp(par[1]), math.exp(par[2])
    at_b, at_a = np.empty(3), np.empty(3)
    for k in range(3):
        at_b[k] = frame[0, k] - d_b * frame[1, k] + par[3] * frame[3, k]
        at_a[k] = frame[0, k] + d_a * frame[2, k] + par[4] * frame[4, k]
        states[1, 0, k] = frame[0, k]
    lines = 0.0
    if speeds[0] > 0.0:
        lines += _knot(at_b, ends[0], speeds[0], lim, states[0], -1.0)
    if speeds[1] > 0.0:
        lines += _knot(at_a, ends[1], speeds[1], lim, states[2], 1.0)
    room = min(best - lines, _PATIENCE * (d_b / max(speeds[0], 1e-9) + d_a / max(speeds[1], 1e-9)))
    durations[:] = 0.0
    if stop:
        states[1, 1:] = 0.0
        if speeds[0] > 0.0:
            durations[0] = least_duration(states[0], states[1], room, lim, samples)
        if speeds[1] > 0.0 and durations[0] < np.inf:
            durations[1] = least_duration(states[1], states[2], room - durations[0], lim, samples)
        total = lines + durations[0] + durations[1]
        return total if total < best else np.inf
    t_b, t_a = d_b / speeds[0] * split, d_a / speeds[1] / split
    low, high = 0.0, 0.96
    p = np.empty((6, 3))
    found = False
    while high * (t_b + t_a) < room:
        if _joint_fits(states, high * t_b, high * t_a, frame, cap, corridor, lim, samples, p):
            found = True
            break
        low, high = high, high * _SCAN
    if not found:
        return np.inf
    for _ in range(8 if samples < 100 else 20):
        middle = 0.5 * (low + high)
        if _joint_fits(states, middle * t_b, middle * t_a, frame, cap, corridor, lim, samples, p):
            high = middle
        else:
            low = middle
    durations[0], durations[1] = high * t_b, high * t_a
    fill_vertex(states[0], states[2], states[1], durations[0], durations[1], cap)
    return lines + durations[0] + durations[1]


@kernel
def _strays(points: Array, waypoint: Array, along: Array, sign: float, corridor: float) -> bool:
    """Whether a control point is further than `corridor` from the ray along a leg.

    The distance to a ray is convex, so the whole segment stays as near as its control points.
    """
    for i in range(6):
        reach, square = 0.0, 0.0
        for k in range(3):
            offset = points[i, k] - waypoint[k]
            reach += sign * offset * along[k]
            square += offset * offset
        square -= max(reach, 0.0) ** 2
        if square > corridor * corridor * (1.0 + 1e-9):
            return True
    return False


@kernel
def _joint_fits(
    states: Array, t_b: float, t_a: float, frame: Array, cap: float, corridor: float, lim: Array,
    samples: int, p: Array,
) -> bool:  # fmt: skip
    fill_vertex(states[0], states[2], states[1], t_b, t_a, cap)
    control_points(states[0], states[1], t_b, p)
    if _strays(p, frame[0], frame[1], -1.0, corridor):
        return False
    if sampled_excess(p, t_b, lim, samples, 1.0) > 1.0:
        return False
    control_points(states[1], states[2], t_a, p)
    if _strays(p, frame[0], frame[2], 1.0, corridor):
        return False
    return sampled_excess(p, t_a, lim, samples, 1.0) <= 1.0


@kernel
def _within(par: Array, rooms: Array, corridor: float) -> bool:
    """Whether knots keep their room along the legs and their corridor beside them."""
    for side in range(2):
        reach = math.exp(par[side])
        if not 0.02 <= reach <= rooms[side] or abs(par[3 + side]) > min(corridor, 0.6 * reach):
            return False
    return True


@kernel
def search_joint(
    par: Array, frame: Array, ends: Array, rooms: Array, speeds: Array, stop: bool, cap: float,
    corridor: float, lim: Array, samples: int, full: bool, states: Array, durations: Array,
) -> float:  # fmt: skip
    """Improve `par` by a pattern search, from a grid of starts where `full`; returns the time."""
    side = 0.0 if stop else corridor
    best = np.inf
    trial = par.copy()
    if not full and _within(par, rooms, side):
        best = joint_time(
            par, frame, ends, speeds, stop, cap, corridor, lim, samples, np.inf, states, durations
        )
    if best == np.inf:
        kept = par.copy()
        for start in range(12 * 6):
            i, j = start // 6, start % 6
            for k in range(2):
                reach = rooms[k] * 0.7**i
                trial[k], trial[3 + k] = math.log(reach), 0.1 * j * reach
            trial[2] = 0.0
            if (stop and j > 0) or not _within(trial, rooms, side):
                continue
            time = joint_time(
                trial, frame, ends, speeds, stop, cap, corridor, lim, samples, best, states,
                durations,
            )  # fmt: skip
            if time < best:
                best = time
                kept[:] = trial
        par[:] = kept
    step = 0.3 if full else 0.1
    while step > 0.004 and best < np.inf:
        before = best
        for move in range(2 * (2 if stop else _MOVES.shape[0])):
            trial[:] = par
            for k in range(5):
                scale = math.exp(par[k - 3]) if k > 2 else 1.0
                trial[k] += (2 * (move % 2) - 1) * step * _MOVES[move // 2, k] * scale
            if not _within(trial, rooms, side):
                continue
            time = joint_time(
                trial, frame, ends, speeds, stop, cap, corridor, lim, samples, best, states,
                durations,
            )  # fmt: skip
            if time < best - 1e-4:
                best = time
                par[:] = trial
        if best == before:
            step *= 0.5
    # trials have overwritten the states
    return joint_time(
        par, frame, ends, speeds, stop, cap, corridor, lim, samples, np.inf, states, durations
    )


@kernel
def solve_joint(
    k: int, full: bool, samples: int, route: Array, stop: Flags, cap: Array, speeds: Array,
    corridor: float, lim: Array, pars: Array, frames: Array, states: Array, durations: Array,
) -> float:  # fmt: skip
    """Search joint k with its neighbours' knots as they are; returns its time with both lines."""
    last = len(route) - 1
    ends, rooms, pace = np.zeros((2, 3)), np.ones(2), np.zeros(2)
    for side in range(2):
        other = k - 1 if side == 0 else k + 1
        if other < 0 or other > last:
            continue
        step = route[other] - route[k]
        length = math.sqrt(step @ step)
        rooms[side] = max(0.97 * length - math.exp(pars[other, 1 - side]), 0.03 * length)
        ends[side] = states[other, 2 - 2 * side, 0]
        pace[side] = speeds[min(k, other)]
    return search_joint(
        pars[k], frames[k], ends, rooms, pace, stop[k], cap[k], corridor, lim, samples, full,
        states[k], durations[k],
    )  # fmt: skip
