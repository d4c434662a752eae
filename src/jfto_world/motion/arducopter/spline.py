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
from jfto_world.compiled import allocating_kernel as kernel
from jfto_world.motion.arducopter.closed_loop import Flight, flight_of_record, flown_state
from jfto_world.motion.arducopter.follower import (
    THRUST,
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
        wpnav.radius_m, step_s, flown_state(points[0], parameters, wind, step_s), reached, record,
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
        _, speeds[k], _ = _allowed(curves[k + 1], 0.0, limits, end, speeds[k + 1], np.zeros((2, 3)))
    return speeds


@kernel
def _along(direction: Array, level: float, up: float, down: float) -> float:
    """Greatest length of a vector in a direction whose parts keep their limits."""
    size = math.sqrt(np.sum(direction * direction))
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
    """At `u` of a leg: metres per u, greatest speed, acceleration; `out`: place and direction."""
    first = curve[1] + u * (2 * curve[2] + 3 * u * curve[3])
    second = 2 * curve[2] + 6 * u * curve[3]
    out[0] = curve[0] + u * (curve[1] + u * (curve[2] + u * curve[3]))
    size = math.sqrt(np.sum(first * first))
    way = first if size > 1e-6 else second
    out[1] = way / math.sqrt(np.sum(way * way))
    across = second - out[1] * np.sum(second * out[1])
    bend = math.sqrt(np.sum(across * across))
    speed = _along(out[1], limits[0], limits[1], limits[2])
    if bend > 1e-9:
        lateral = _along(across, limits[3], limits[4], limits[4])
        speed = min(speed, size * math.sqrt(lateral / bend))
    accel = _along(out[1], limits[3], limits[4], limits[4])
    rest = end - out[0]
    left = math.sqrt(np.sum(rest * rest))
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
    reached_s: Array,
    record: Array,
) -> int:
    """Fill `record` and `reached_s`; returns the number of steps, or 0 if they did not suffice."""
    target, frame = np.zeros((3, 3)), np.zeros((2, 3))
    target[0] = curves[0, 0]
    leg, u, speed = 0, 0.0, 0.0
    for i in range(len(record)):
        record[i, :6] = state[:6]
        record[i, 6:9] = target[0]
        record[i, 9] = np.hypot(state[THRUST], state[THRUST + 1])
        if leg == len(curves):
            return i + 1
        step = clock_step(state, target, parameters, dt_s) * dt_s / _SUBSTEPS
        follow_step(state, target, parameters, wind[0], wind[1], dt_s)
        end = curves[leg, 0] + curves[leg, 1] + curves[leg, 2] + curves[leg, 3]
        for _ in range(_SUBSTEPS):
            if u >= 1.0:
                break
            size, most, accel = _allowed(curves[leg], u, limits, end, end_speeds[leg], frame)
            ahead = speed * step
            speed = min(max(most, speed - accel * step), speed + accel * step)
            target[0], target[1] = frame[0], speed * frame[1]
            if size > 1e-6:
                u += ahead / size
            else:
                second = 2 * curves[leg, 2] + 6 * u * curves[leg, 3]
                u += math.sqrt(2.0 * ahead / math.sqrt(np.sum(second * second)))
        if u >= 1.0:
            away = end - state[:3]
            if leg + 1 == len(curves):
                target[0], target[1] = end, 0.0
            if leg + 1 < len(curves) or np.sqrt(np.sum(away * away)) <= radius_m:
                leg, u = leg + 1, 0.0
                reached_s[leg] = (i + 1) * dt_s
    return 0
