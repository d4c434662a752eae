"""The position controller and the vehicle that follow the planner's target, one step at a time.

A vehicle is a row of numbers whose columns the constants name.
"""

from __future__ import annotations

import math

import numpy as np

from jfto_msgs_py.types import Array
from jfto_msgs_py.units import GRAVITY_MPS2
from jfto_world.compiled import inner, kernel
from jfto_world.motion.arducopter.wpnav import Airframe, WpNav

POSITION, VELOCITY = 0, 3  # 3 each, ENU
THRUST = 6  # horizontal acceleration asked of the tilt, lagged, 2
INTEGRAL, ERROR, SLOPE = 8, 10, 12  # velocity error: integral, filtered, its filtered slope, 2 each
HEADING = 14  # unit vector of the nose, 2
RATE = 16  # rate of the planner's clock
STATE = 17

_POSITION_GAIN = 1.0
_VELOCITY_P, _VELOCITY_I, _VELOCITY_D = 2.0, 1.0, 0.5
_INTEGRAL_MAX_MPS2 = 10.0
_FILTER_S = 1.0 / (2.0 * math.pi * 5.0)
_TURN_S = 0.7
_CLOCK_SPARE, _CLOCK_MIN = 0.05, 0.1


def hover_state(position_m: Array, heading_deg: float = 0.0) -> Array:
    """State row of a vehicle that hovers at a point; heading clockwise from north."""
    state = np.zeros(STATE)
    state[:3] = position_m
    state[HEADING] = np.sin(np.radians(heading_deg))
    state[HEADING + 1] = np.cos(np.radians(heading_deg))
    state[RATE] = 1.0
    return state


def follower_parameters(wpnav: WpNav, airframe: Airframe) -> Array:
    """The row of 6 numbers that `follow_step` and `clock_step` take."""
    return np.array(
        [
            wpnav.tilt_accel_mps2,
            airframe.drag_linear_1ps,
            airframe.drag_quadratic_1pm,
            airframe.attitude_lag_s,
            airframe.climb_lag_s,
            wpnav.accel_mps2 / wpnav.jerk_mps3,
        ]
    )


@kernel
def clock_step(state: Array, target: Array, parameters: Array, dt_s: float) -> float:
    """Advance and return the rate of the planner's clock, which slows while the vehicle lags.

    The rate follows clamp(0.05 + (v_track - e) / v_target, 0.1, 1) with time constant a / J
    (`parameters[5]`); e is the position error and v_track the speed, both along the
    target's velocity. `target` is (3, 3): position, velocity, acceleration.
    """
    speed = math.sqrt(target[1, 0] ** 2 + target[1, 1] ** 2 + target[1, 2] ** 2)
    wanted = 1.0
    if speed > 1e-6:
        error, track = 0.0, 0.0
        for axis in range(3):
            unit = target[1, axis] / speed
            error += (target[0, axis] - state[POSITION + axis]) * unit
            track += state[VELOCITY + axis] * unit
        wanted = _CLOCK_SPARE + (track - _POSITION_GAIN * error) / speed
        wanted = min(1.0, max(_CLOCK_MIN, wanted))
    state[RATE] += (wanted - state[RATE]) * min(1.0, dt_s / parameters[5])
    return state[RATE]


@inner
def _limit_tilt(
    east: float, north: float, velocity: Array, limit: float
) -> tuple[bool, float, float]:
    """Cut a horizontal acceleration to `limit`, keeping its part across the velocity.

    Returns whether it had to be cut, and what is left of it.
    """
    if math.sqrt(east**2 + north**2) <= limit:
        return False, east, north
    speed = math.sqrt(velocity[0] ** 2 + velocity[1] ** 2)
    if speed < 1e-6:
        scale = limit / math.sqrt(east**2 + north**2)
        return True, east * scale, north * scale
    ue, un = velocity[0] / speed, velocity[1] / speed
    along = east * ue + north * un
    across = north * ue - east * un
    across = min(limit, max(-limit, across))
    room = math.sqrt(limit * limit - across * across)
    along = min(room, max(-room, along))
    return True, along * ue - across * un, along * un + across * ue


@inner
def _wish(state: Array, target: Array, axis: int, alpha: float, dt_s: float) -> float:
    """Horizontal acceleration that the position controller asks for along an axis, uncut.

    The filters of the velocity error go on in `state`.
    """
    wish = target[1, axis] + _POSITION_GAIN * (target[0, axis] - state[POSITION + axis])
    before = state[ERROR + axis]
    state[ERROR + axis] += alpha * (wish - state[VELOCITY + axis] - before)
    slope = (state[ERROR + axis] - before) / dt_s
    state[SLOPE + axis] += alpha * (slope - state[SLOPE + axis])
    return (
        target[2, axis]
        + _VELOCITY_P * state[ERROR + axis]
        + state[INTEGRAL + axis]
        + _VELOCITY_D * state[SLOPE + axis]
    )


@kernel
def follow_step(
    state: Array, target: Array, parameters: Array, wind_e: float, wind_n: float, dt_s: float
) -> None:
    """Advance `state` by `dt_s` towards `target`, in place; wind in m/s, where it blows to.

    Horizontal: velocity demand = target velocity + position error; acceleration demand = target
    acceleration + PID of the velocity error, cut at the tilt limit (the integral may then only
    shrink), lagged. Vertical: velocity follows with a lag and feed-forward. `parameters`: tilt
    limit in m/s², linear drag, quadratic drag along each body axis, attitude lag, climb lag, and
    the time constant of the planner's clock.
    """
    alpha = dt_s / (dt_s + _FILTER_S)
    east = _wish(state, target, 0, alpha, dt_s)
    north = _wish(state, target, 1, alpha, dt_s)
    cut, east, north = _limit_tilt(east, north, target[1], parameters[0])
    lag = 1.0 - math.exp(-dt_s / parameters[3])
    for axis in range(2):
        held = state[INTEGRAL + axis] + _VELOCITY_I * state[ERROR + axis] * dt_s
        if not cut or abs(held) < abs(state[INTEGRAL + axis]):
            state[INTEGRAL + axis] = min(_INTEGRAL_MAX_MPS2, max(-_INTEGRAL_MAX_MPS2, held))
        state[THRUST + axis] += lag * ((east if axis == 0 else north) - state[THRUST + axis])
    climb = target[1, 2] + _POSITION_GAIN * (target[0, 2] - state[POSITION + 2])
    accel_u = target[2, 2] + (climb - state[VELOCITY + 2]) / parameters[4]
    _turn(state, target, dt_s)
    _move(state, parameters, wind_e, wind_n, accel_u, dt_s)


@inner
def _turn(state: Array, target: Array, dt_s: float) -> None:
    """Let the nose follow the target's horizontal velocity."""
    speed = math.sqrt(target[1, 0] ** 2 + target[1, 1] ** 2)
    if speed < 0.1:
        return
    he = state[HEADING] + (target[1, 0] / speed - state[HEADING]) * dt_s / _TURN_S
    hn = state[HEADING + 1] + (target[1, 1] / speed - state[HEADING + 1]) * dt_s / _TURN_S
    size = math.sqrt(he * he + hn * hn)
    if size > 1e-6:
        state[HEADING], state[HEADING + 1] = he / size, hn / size


@inner
def _move(
    state: Array, parameters: Array, wind_e: float, wind_n: float, accel_u: float, dt_s: float
) -> None:
    """Thrust along the tilted rotor axis, drag along the three body axes, and motion.

    The rotors' own drag is linear and grows with the root of the thrust (they turn faster), that
    of the body is quadratic along each axis. The thrust is what gives `accel_u` against both.
    """
    tilt_e, tilt_n = state[THRUST], state[THRUST + 1]
    he, hn = state[HEADING], state[HEADING + 1]
    if he == 0.0 and hn == 0.0:
        hn = 1.0
    size = math.sqrt(tilt_e * tilt_e + tilt_n * tilt_n + GRAVITY_MPS2 * GRAVITY_MPS2)
    ue, un, uu = tilt_e / size, tilt_n / size, GRAVITY_MPS2 / size
    # the least rotation that tilts the rotor axis carries the nose and the side along
    lean = (he * ue + hn * un) / (1.0 + uu)
    ae, an, au = he - lean * ue, hn - lean * un, -lean * (1.0 + uu)
    se, sn, su = un * au - uu * an, uu * ae - ue * au, ue * an - un * ae
    air_e, air_n = state[VELOCITY] - wind_e, state[VELOCITY + 1] - wind_n
    air_u = state[VELOCITY + 2]
    ahead = air_e * ae + air_n * an + air_u * au
    aside = air_e * se + air_n * sn + air_u * su
    above = air_e * ue + air_n * un + air_u * uu
    thrust = (GRAVITY_MPS2 + accel_u) / uu
    drag_e, drag_n = 0.0, 0.0
    for _ in range(3):
        linear = parameters[1] * math.sqrt(max(thrust, 0.0) / GRAVITY_MPS2)
        x = ahead * (linear + parameters[2] * abs(ahead))
        y = aside * (linear + parameters[2] * abs(aside))
        z = above * (linear + parameters[2] * abs(above))
        drag_e = x * ae + y * se + z * ue
        drag_n = x * an + y * sn + z * un
        thrust = (GRAVITY_MPS2 + accel_u + x * au + y * su + z * uu) / uu
    accel_e = thrust * ue - drag_e
    accel_n = thrust * un - drag_n
    _accelerate(state, 0, accel_e, dt_s)
    _accelerate(state, 1, accel_n, dt_s)
    _accelerate(state, 2, accel_u, dt_s)


@inner
def _accelerate(state: Array, axis: int, accel: float, dt_s: float) -> None:
    state[POSITION + axis] += dt_s * (state[VELOCITY + axis] + 0.5 * dt_s * accel)
    state[VELOCITY + axis] += dt_s * accel
