"""A whole route flown: the planner's clock slows when the vehicle cannot follow."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from jfto_msgs_py.errors import InfeasibleError
from jfto_msgs_py.types import Array, Flags
from jfto_world.compiled import inner, kernel
from jfto_world.kernel_struct import KernelStruct
from jfto_world.motion.arducopter.follower import (
    THRUST,
    clock_step,
    follow_step,
    follower_parameters,
    hover_state,
)
from jfto_world.motion.arducopter.leg_profile import DURATION, along_leg
from jfto_world.motion.arducopter.target import plan_target, route_arrays
from jfto_world.motion.arducopter.wpnav import Airframe, WpNav

_SLOWEST_CLOCK = 0.1
_SETTLE_MAX_S = 60.0
_HOVER_S = 30.0


@dataclass(frozen=True)
class Flight:
    """A flown route: `reached_s` (M,) and the vehicle's track, sampled every `step_s` from 0.

    `position_m` and `velocity_mps` are (K, 3); `target_m` (K, 3) is what the planner asked for;
    `tilt_accel_mps2` (K,) is the horizontal acceleration made by tilting.
    """

    reached_s: Array
    step_s: float
    position_m: Array
    velocity_mps: Array
    target_m: Array
    tilt_accel_mps2: Array

    def positions(self, times_s: Array) -> Array:
        """Positions at the given times, (T, 3), linear between samples, held before and after."""
        grid = np.arange(len(self.position_m)) * self.step_s
        return np.stack([np.interp(times_s, grid, self.position_m[:, k]) for k in range(3)], -1)


def fly_route(
    points_m: Array,
    wpnav: WpNav,
    airframe: Airframe | None = None,
    *,
    stop: Flags | None = None,
    hold_s: Array | None = None,
    wind_mps: tuple[float, float] = (0.0, 0.0),
    step_s: float = 0.02,
) -> Flight:
    """Fly a route in closed loop, from a hover at its first point.

    A stop counts as reached once the target rests there and the vehicle is within the waypoint
    radius; then the hold runs.

    Parameters
    ----------
    points_m
        (M, 3), ENU m.
    wpnav
        Parameters of the autopilot.
    airframe
        Drag and lag; None: the simulated quadcopter.
    stop
        (M,), where to stop; None: at the ends.
    hold_s
        (M,), how long to stay; None: not at all.
    wind_mps
        East and north, where the air moves to.
    step_s
        Of the simulation.

    Returns
    -------
    Flight
        The motion, and when points were reached.

    Raises
    ------
    InfeasibleError
        The vehicle never gets there: wind beyond its tilt.
    """
    points, stops, holds = route_arrays(points_m, stop, hold_s)
    track = plan_target(points, wpnav, stops, holds)
    parameters = follower_parameters(wpnav, airframe or Airframe())
    budget = track.duration_s / _SLOWEST_CLOCK + _SETTLE_MAX_S * (len(points) + 1)
    record = np.zeros((int(np.ceil(budget / step_s)) + 1, 10))
    reached = np.zeros(len(points))
    wind = np.array(wind_mps, dtype=np.float64)
    route = _Route(points, track.legs, track.half_overlap_s, stops, holds, wpnav.radius_m)
    air = _Air(parameters, wind, step_s)
    room = _Room(
        flown_state(points[0], parameters, wind, step_s), np.zeros(len(points)), np.zeros((3, 3))
    )
    count = _fly(route, air, room, reached, record)
    return flight_of_record(record, count, reached, step_s, budget, wpnav, wind)


def flown_state(point_m: Array, parameters: Array, wind: Array, step_s: float) -> Array:
    """State of a vehicle that has hovered over a point for long enough to lean into the wind."""
    state = hover_state(point_m)
    if wind.any():
        target = np.zeros((3, 3))
        target[0] = point_m
        for _ in range(int(_HOVER_S / step_s)):
            follow_step(state, target, parameters, wind[0], wind[1], step_s)
    return state


def flight_of_record(
    record: Array,
    count: int,
    reached_s: Array,
    step_s: float,
    budget_s: float,
    wpnav: WpNav,
    wind: Array,
) -> Flight:
    """The flight of `count` recorded steps; raises InfeasibleError where they did not suffice."""
    if count == 0:
        late = int(np.argmax(reached_s[1:] == 0)) + 1
        raise InfeasibleError(
            f"Point {late} of the route is not reached within {budget_s:.0f} s: the wind of "
            f"{np.hypot(*wind):.1f} m/s and the route's speeds ask for more tilt than "
            f"{wpnav.angle_max_deg:g}°.",
            cures=("lower the speed", "raise the tilt limit", "wait for less wind"),
        )
    kept = record[:count].copy()
    return Flight(reached_s, step_s, kept[:, :3], kept[:, 3:6], kept[:, 6:9], kept[:, 9])


@inner
def _aim(points: Array, legs: Array, elapsed: Array, leg: int, target: Array) -> None:
    """Target from the previous leg, this leg and the next, each at its own time `elapsed`."""
    first = max(leg - 1, 0)
    for axis in range(3):
        target[0, axis] = points[first, axis]
        target[1, axis] = target[2, axis] = 0.0
    for k in range(first, min(leg + 2, len(legs))):
        x, w, a = along_leg(legs[k], elapsed[k])
        for axis in range(3):
            target[0, axis] += x * legs[k, axis]
            target[1, axis] += w * legs[k, axis]
            target[2, axis] += a * legs[k, axis]


@inner
def note(row: Array, state: Array, target: Array) -> None:
    """Write position, velocity, target and the acceleration made by tilting into a row (10,)."""
    for k in range(6):
        row[k] = state[k]
    for k in range(3):
        row[6 + k] = target[0, k]
    row[9] = np.hypot(state[THRUST], state[THRUST + 1])


@inner
def distance(state: Array, point: Array) -> float:
    """Distance of a vehicle from a point."""
    dx, dy, dz = point[0] - state[0], point[1] - state[1], point[2] - state[2]
    return math.sqrt(dx * dx + dy * dy + dz * dz)


@dataclass(frozen=True)
class _Route(KernelStruct):
    """What is flown, as in `TargetTrack`: a stop counts as reached within `radius_m`."""

    points: Array
    legs: Array
    half_s: Array
    stop: Flags
    hold_s: Array
    radius_m: float


@dataclass(frozen=True)
class _Air(KernelStruct):
    """The vehicle's parameters and the wind (2,), m/s, in steps of `dt_s`."""

    parameters: Array
    wind: Array
    dt_s: float


@dataclass(frozen=True)
class _Room(KernelStruct):
    """The vehicle's state at first, and room to work in: `elapsed` (M,), `target` (3, 3), zero."""

    state: Array
    elapsed: Array
    target: Array


@kernel
def _fly(route: _Route, air: _Air, room: _Room, reached_s: Array, record: Array) -> int:
    """Fill `record` and `reached_s`; returns the number of steps, or 0 if they did not suffice."""
    points, legs, stop, dt_s = route.points, route.legs, route.stop, air.dt_s
    state, elapsed, target, wind = room.state, room.elapsed, room.target, air.wind
    count = len(legs)
    for axis in range(3):
        target[0, axis] = points[0, axis]
    leg, waiting = 0, -1.0
    for i in range(len(record)):
        note(record[i], state, target)
        if leg == count:
            return i + 1
        now = (i + 1) * dt_s
        step = clock_step(state, target, air.parameters, dt_s) * dt_s
        follow_step(state, target, air.parameters, wind[0], wind[1], dt_s)
        first = max(leg - 1, 0)
        if leg > 0:
            elapsed[first] += step
        elapsed[leg] += step
        rest = legs[leg, DURATION] - elapsed[leg]
        over = route.half_s[leg + 1]
        if over > 0.0 and rest <= 2.0 * over:
            elapsed[leg + 1] = 2.0 * over - rest
        _aim(points, legs, elapsed, leg, target)
        if not stop[leg + 1]:
            if rest <= over:
                leg += 1
                reached_s[leg] = now
        elif rest <= 0.0:
            if waiting < 0.0:
                if distance(state, points[leg + 1]) <= route.radius_m:
                    waiting = 0.0
            else:
                waiting += dt_s
            if waiting >= route.hold_s[leg + 1]:
                leg += 1
                reached_s[leg] = now
                waiting = -1.0
    return 0
