"""Missions of spline waypoints in time, for flights recorded with them; our missions have none.

Each leg is a cubic Hermite curve. The planner keeps no jerk limit there: at each place the speed is
what slope, lateral acceleration and the braking distance allow, and changes at half of the
acceleration. Straight legs with rounded corners are faster (docs/explanation/trajectories.md).
"""

from __future__ import annotations

import math

import numpy as np

from jfto_msgs_py.errors import InputError
from jfto_msgs_py.types import Array
from jfto_world.compiled import inner, kernel
from jfto_world.motion.arducopter.closed_loop import (
    Flight,
    distance,
    flight_of_record,
    flown_state,
    note,
)
from jfto_world.motion.arducopter.follower import (
    clock_step,
    follow_step,
    follower_parameters,
)
from jfto_world.motion.arducopter.target import route_arrays
from jfto_world.motion.arducopter.wpnav import Airframe, WpNav

# end vectors together longer than so many times the chord are shortened
_VECTORS_PER_CHORD = 4.0
# the planner runs so many times as often as the vehicle is stepped
_SUBSTEPS = 8
_SLOWEST_MPS = 0.05
# rows of what is known at one place of a leg
PLACE, DIRECTION, FIRST, SECOND, ACROSS, END = range(6)
ROWS = 6


def fly_splines(
    points_m: Array,
    wpnav: WpNav,
    airframe: Airframe | None = None,
    *,
    wind_mps: tuple[float, float] = (0.0, 0.0),
    step_s: float = 0.02,
) -> Flight:
    """Fly a route of spline waypoints, flown through, in closed loop from a hover at its start.

    `points_m` is (M, 3) ENU metres, M >= 2; wind in m/s (east, north) is where the air moves to.
    Raises InputError on a shape that is none or a point that comes twice, InfeasibleError where
    the vehicle never gets there.
    """
    points, _, _ = route_arrays(points_m, None, None)
    chords = np.linalg.norm(np.diff(points, axis=0), axis=1)
    if not len(chords) or chords.min() == 0.0:
        raise InputError("points_m of a spline must be two or more, each off the one before.")
    parameters = follower_parameters(wpnav, airframe or Airframe())
    wind = np.array(wind_mps, dtype=np.float64)
    reached = np.zeros(len(points))
    budget = chords.sum() / _SLOWEST_MPS
    record = np.zeros((math.ceil(budget / step_s), 10))
    count = _fly_splines(
        _hermite(points), _end_speeds(points, wpnav), _limits(wpnav), parameters, wind,
        wpnav.radius_m, step_s, flown_state(points[0], parameters, wind, step_s),
        np.zeros((3, 3)), np.zeros((ROWS, 3)), reached, record,
    )  # fmt: skip
    return flight_of_record(record, count, reached, step_s, budget, wpnav, wind)


def _hermite(points: Array) -> Array:
    """Polynomials (M - 1, 4, 3) of the legs in u in [0, 1], lowest power first."""
    tangent = np.zeros_like(points)
    tangent[1:-1] = points[2:] - points[:-2]
    begin, end = tangent[:-1].copy(), tangent[1:].copy()
    step = np.diff(points, axis=0)
    size = np.linalg.norm(begin + end, axis=1)
    most = _VECTORS_PER_CHORD * np.linalg.norm(step, axis=1)
    scale = np.where(size > most, most / np.maximum(size, 1e-9), 1.0)[:, None]
    begin, end = begin * scale, end * scale
    return np.stack([points[:-1], begin, 3 * step - 2 * begin - end, begin + end - 2 * step], 1)


def _limits(wpnav: WpNav) -> Array:
    """Speeds level, up, down, and half of the accelerations level and vertical."""
    half = 0.5
    return np.array(
        [
            wpnav.speed_mps,
            wpnav.speed_up_mps,
            wpnav.speed_dn_mps,
            half * wpnav.accel_mps2,
            half * wpnav.accel_z_mps2,
        ]
    )


def _end_speeds(points: Array, wpnav: WpNav) -> Array:
    """Speed with which each leg may end, (M - 1,): that with which the next one may begin."""
    curves, limits = _hermite(points), _limits(wpnav)
    speeds = np.zeros(len(curves))
    for k in range(len(curves) - 2, -1, -1):
        end = curves[k + 1].sum(axis=0)
        room = np.zeros((ROWS, 3))
        _, speeds[k], _ = _allowed(curves[k + 1], 0.0, limits, end, speeds[k + 1], room)
    return speeds


@inner
def _length(vector: Array) -> float:
    return math.sqrt(vector[0] * vector[0] + vector[1] * vector[1] + vector[2] * vector[2])


@inner
def _along(direction: Array, level: float, up: float, down: float) -> float:
    """Greatest length of a vector in a direction whose parts keep their limits."""
    size = _length(direction)
    if size == 0.0:
        return level
    flat = math.sqrt(direction[0] ** 2 + direction[1] ** 2) / size
    rise = direction[2] / size
    found = math.inf
    if flat > 0.0:
        found = level / flat
    if rise > 0.0:
        found = min(found, up / rise)
    elif rise < 0.0:
        found = min(found, -down / rise)
    return found


@kernel
def _allowed(
    curve: Array, u: float, limits: Array, end: Array, end_speed: float, out: Array
) -> tuple[float, float, float]:
    """At `u` of a leg: metres per u, greatest speed, acceleration; `out` (ROWS, 3): place,
    direction, first and second derivative, and the latter's part across the direction.
    """
    for k in range(3):
        out[FIRST, k] = curve[1, k] + u * (2 * curve[2, k] + 3 * u * curve[3, k])
        out[SECOND, k] = 2 * curve[2, k] + 6 * u * curve[3, k]
        out[PLACE, k] = curve[0, k] + u * (curve[1, k] + u * (curve[2, k] + u * curve[3, k]))
    size = _length(out[FIRST])
    way = out[FIRST] if size > 1e-6 else out[SECOND]
    length = _length(way)
    turned = 0.0
    for k in range(3):
        out[DIRECTION, k] = way[k] / length
        turned += out[SECOND, k] * out[DIRECTION, k]
    for k in range(3):
        out[ACROSS, k] = out[SECOND, k] - out[DIRECTION, k] * turned
    bend = _length(out[ACROSS])
    speed = _along(out[DIRECTION], limits[0], limits[1], limits[2])
    if bend > 1e-9:
        lateral = _along(out[ACROSS], limits[3], limits[4], limits[4])
        speed = min(speed, size * math.sqrt(lateral / bend))
    accel = _along(out[DIRECTION], limits[3], limits[4], limits[4])
    left = distance(out[PLACE], end)
    speed = min(speed, math.sqrt(2.0 * accel * left + end_speed * end_speed))
    return size, speed, accel


@kernel
def _fly_splines(
    curves: Array,
    end_speeds: Array,
    limits: Array,
    parameters: Array,
    wind: Array,
    radius_m: float,
    dt_s: float,
    state: Array,
    target: Array,
    frame: Array,
    reached_s: Array,
    record: Array,
) -> int:
    """Fill `record` and `reached_s`; returns the number of steps, or 0 if they did not suffice.

    `target` (3, 3), zero, and `frame` (ROWS, 3) are room to work in.
    """
    for k in range(3):
        target[0, k] = curves[0, 0, k]
    leg, u, speed = 0, 0.0, 0.0
    for i in range(len(record)):
        note(record[i], state, target)
        if leg == len(curves):
            return i + 1
        step = clock_step(state, target, parameters, dt_s) * dt_s / _SUBSTEPS
        follow_step(state, target, parameters, wind[0], wind[1], dt_s)
        for k in range(3):
            frame[END, k] = 0.0
            for power in range(4):
                frame[END, k] += curves[leg, power, k]
        for _ in range(_SUBSTEPS):
            if u >= 1.0:
                break
            size, most, accel = _allowed(curves[leg], u, limits, frame[END], end_speeds[leg], frame)
            ahead = speed * step
            speed = min(max(most, speed - accel * step), speed + accel * step)
            for k in range(3):
                target[0, k], target[1, k] = frame[PLACE, k], speed * frame[DIRECTION, k]
            u += ahead / size if size > 1e-6 else math.sqrt(2.0 * ahead / _length(frame[SECOND]))
        if u >= 1.0:
            if leg + 1 == len(curves):
                for k in range(3):
                    target[0, k], target[1, k] = frame[END, k], 0.0
            if leg + 1 < len(curves) or distance(state, frame[END]) <= radius_m:
                leg, u = leg + 1, 0.0
                reached_s[leg] = (i + 1) * dt_s
    return 0
