"""The joints of one route, compiled: the segments around a waypoint, searched for the least time.

A corner is a pair of segments from cruise on one leg through the waypoint to cruise on the next.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from jfto_msgs_py.types import Array, Flags
from jfto_planner.smoothing.kernel.segment import (
    CLIMB,
    DESCENT,
    SCAN,
    SPEED,
    control_points,
    fill_vertex,
    least_duration,
    sampled_excess,
)
from jfto_world.compiled import inner, kernel
from jfto_world.kernel_struct import KernelStruct

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
_PATIENCE = 6.0  # durations are tried up to this many times those at cruise speed
_FINE = 256  # samples per segment of final durations


@dataclass(frozen=True, eq=False)
class Joint(KernelStruct):
    """What belongs to the joint that is worked on, one after the other.

    `ends` (2, 3): the neighbours' knots; `pace` (2,): cruise speed of both legs, 0 where there is
    none; `rooms` (2,): the longest distance of its own knots. `knots` (2, 3), `control` (6, 3),
    `trial` and `kept` (5,) are room to work in.
    """

    ends: Array
    pace: Array
    rooms: Array
    knots: Array
    control: Array
    trial: Array
    kept: Array


@dataclass(frozen=True, eq=False)
class Route(KernelStruct):
    """A route of M points: what is given of it, and what is searched.

    Given: `points` (M, 3), where to `stop` (M,), the greatest speed there (M,), `lim` (8,), and how
    far a curve may leave the legs. Searched: `speeds` (M - 1,) of cruise; `pars` (M, 5) the outer
    variables of each joint: log distance of the knots before and after the waypoint, log of the
    split of time between them, sideways offset of both knots; `frames` (M, 5, 3): waypoint,
    direction of both legs, sideways direction of both knots; `states` (M, 3, 3, 3) before, at and
    after the waypoint, and the `durations` (M, 2) between.
    """

    points: Array
    stop: Flags
    cap: Array
    lim: Array
    corridor: float
    speeds: Array
    pars: Array
    frames: Array
    states: Array
    durations: Array
    joint: Joint


def new_joint() -> Joint:
    """Room for one joint."""
    return Joint(
        ends=np.zeros((2, 3)),
        pace=np.zeros(2),
        rooms=np.zeros(2),
        knots=np.zeros((2, 3)),
        control=np.zeros((6, 3)),
        trial=np.zeros(5),
        kept=np.zeros(5),
    )


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
def solve_joint(route: Route, k: int, full: bool, samples: int) -> float:
    """Search joint k with its neighbours' knots as they are; returns its time with both lines.

    Improves its parameters by a pattern search, from a grid of starts where `full`.
    """
    _meet_neighbours(route, k)
    par, trial = route.pars[k], route.joint.trial
    side = 0.0 if route.stop[k] else route.corridor
    best = np.inf
    if not full and _within(par, route.joint.rooms, side):
        best = _joint_time(route, k, par, samples, np.inf)
    if best == np.inf:
        best = _best_start(route, k, side, samples)
    step = 0.3 if full else 0.1
    while step > 0.004 and best < np.inf:
        before = best
        for move in range(2 * (2 if route.stop[k] else _MOVES.shape[0])):
            for i in range(5):
                scale = math.exp(par[i - 3]) if i > 2 else 1.0
                change = (2 * (move % 2) - 1) * step * _MOVES[move // 2, i] * scale
                trial[i] = par[i] + change
            if not _within(trial, route.joint.rooms, side):
                continue
            time = _joint_time(route, k, trial, samples, best)
            if time < best - 1e-4:
                best = time
                _copy(trial, par)
        if best == before:
            step *= 0.5
    # trials have overwritten the states
    return _joint_time(route, k, par, samples, np.inf)


@kernel
def fix_joint(route: Route, k: int) -> float:
    """Final durations of joint k, sampled densely; returns its time with both lines."""
    _meet_neighbours(route, k)
    return _joint_time(route, k, route.pars[k], _FINE, np.inf)


@inner
def _copy(source: Array, out: Array) -> None:
    for i in range(len(out)):
        out[i] = source[i]


@inner
def _meet_neighbours(route: Route, k: int) -> None:
    """Set what the joint's neighbours leave it: their knots, its cruise speeds and its room."""
    joint = route.joint
    for side in range(2):
        other = k - 1 if side == 0 else k + 1
        for axis in range(3):
            joint.ends[side, axis] = 0.0
        joint.pace[side], joint.rooms[side] = 0.0, 1.0
        if other < 0 or other >= len(route.points):
            continue
        square = 0.0
        for axis in range(3):
            square += (route.points[other, axis] - route.points[k, axis]) ** 2
            joint.ends[side, axis] = route.states[other, 2 - 2 * side, 0, axis]
        length = math.sqrt(square)
        reach = math.exp(route.pars[other, 1 - side])
        joint.rooms[side] = max(0.97 * length - reach, 0.03 * length)
        joint.pace[side] = route.speeds[min(k, other)]


@inner
def _within(par: Array, rooms: Array, corridor: float) -> bool:
    """Whether knots keep their room along the legs and their corridor beside them."""
    for side in range(2):
        reach = math.exp(par[side])
        if not 0.02 <= reach <= rooms[side] or abs(par[3 + side]) > min(corridor, 0.6 * reach):
            return False
    return True


@inner
def _best_start(route: Route, k: int, side: float, samples: int) -> float:
    """Set the joint's parameters to the best of a grid; returns its time, inf if none fits."""
    trial, kept, rooms = route.joint.trial, route.joint.kept, route.joint.rooms
    best = np.inf
    _copy(route.pars[k], kept)
    for start in range(12 * 6):
        i, j = start // 6, start % 6
        for knot in range(2):
            reach = rooms[knot] * 0.7**i
            trial[knot], trial[3 + knot] = math.log(reach), 0.1 * j * reach
        trial[2] = 0.0
        if (route.stop[k] and j > 0) or not _within(trial, rooms, side):
            continue
        time = _joint_time(route, k, trial, samples, best)
        if time < best:
            best = time
            _copy(trial, kept)
    _copy(kept, route.pars[k])
    return best


@inner
def _knot(at: Array, far: Array, speed: float, lim: Array, state: Array, sign: float) -> float:
    """Set `state` to cruise at `at`, on the line to `far` (sign 1) or from it (-1); line time."""
    dx, dy, dz = sign * (far[0] - at[0]), sign * (far[1] - at[1]), sign * (far[2] - at[2])
    size = math.sqrt(dx * dx + dy * dy + dz * dz)
    cruise = min(speed, leg_limit(dx, dy, dz, lim))
    state[1, 0], state[1, 1], state[1, 2] = (
        cruise * dx / size,
        cruise * dy / size,
        cruise * dz / size,
    )
    for k in range(3):
        state[0, k], state[2, k] = at[k], 0.0
    return size / cruise


@inner
def _joint_time(route: Route, k: int, par: Array, samples: int, best: float) -> float:
    """Time from the previous joint's last knot to the next joint's first one; inf if none fits.

    Fills the joint's states and durations for `par`. Gives up, with inf, where the time would
    exceed `best`.
    """
    joint, frame, lim = route.joint, route.frames[k], route.lim
    states, durations, pace = route.states[k], route.durations[k], joint.pace
    d_b, d_a, split = math.exp(par[0]), math.exp(par[1]), math.exp(par[2])
    for axis in range(3):
        joint.knots[0, axis] = frame[0, axis] - d_b * frame[1, axis] + par[3] * frame[3, axis]
        joint.knots[1, axis] = frame[0, axis] + d_a * frame[2, axis] + par[4] * frame[4, axis]
        states[1, 0, axis] = frame[0, axis]
    lines = 0.0
    if pace[0] > 0.0:
        lines += _knot(joint.knots[0], joint.ends[0], pace[0], lim, states[0], -1.0)
    if pace[1] > 0.0:
        lines += _knot(joint.knots[1], joint.ends[1], pace[1], lim, states[2], 1.0)
    room = min(best - lines, _PATIENCE * (d_b / max(pace[0], 1e-9) + d_a / max(pace[1], 1e-9)))
    durations[0] = durations[1] = 0.0
    if route.stop[k]:
        _come_to_rest(route, k, room, samples)
        total = lines + durations[0] + durations[1]
        return total if total < best else np.inf
    t_b, t_a = d_b / pace[0] * split, d_a / pace[1] / split
    low, high = 0.0, 0.96
    found = False
    while high * (t_b + t_a) < room:
        if _fits(route, k, high * t_b, high * t_a, samples):
            found = True
            break
        low, high = high, high * SCAN
    if not found:
        return np.inf
    for _ in range(8 if samples < 100 else 20):
        middle = 0.5 * (low + high)
        if _fits(route, k, middle * t_b, middle * t_a, samples):
            high = middle
        else:
            low = middle
    durations[0], durations[1] = high * t_b, high * t_a
    fill_vertex(states[0], states[2], states[1], durations[0], durations[1], route.cap[k])
    return lines + durations[0] + durations[1]


@inner
def _come_to_rest(route: Route, k: int, room: float, samples: int) -> None:
    """Fill the durations of both segments around a stop, inf where they take more than `room`."""
    joint, states, durations = route.joint, route.states[k], route.durations[k]
    for axis in range(3):
        states[1, 1, axis] = states[1, 2, axis] = 0.0
    if joint.pace[0] > 0.0:
        durations[0] = least_duration(states[0], states[1], room, route.lim, samples, joint.control)
    if joint.pace[1] > 0.0 and durations[0] < np.inf:
        durations[1] = least_duration(
            states[1], states[2], room - durations[0], route.lim, samples, joint.control
        )


@inner
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


@inner
def _fits(route: Route, k: int, t_b: float, t_a: float, samples: int) -> bool:
    """Whether the joint's two segments keep the limits and the corridor with these durations."""
    states, frame, p, lim = route.states[k], route.frames[k], route.joint.control, route.lim
    fill_vertex(states[0], states[2], states[1], t_b, t_a, route.cap[k])
    control_points(states[0], states[1], t_b, p)
    if _strays(p, frame[0], frame[1], -1.0, route.corridor):
        return False
    if sampled_excess(p, t_b, lim, samples, 1.0) > 1.0:
        return False
    control_points(states[1], states[2], t_a, p)
    if _strays(p, frame[0], frame[2], 1.0, route.corridor):
        return False
    return sampled_excess(p, t_a, lim, samples, 1.0) <= 1.0
