"""The waypoint planner in flight: legs one after another, corners rounded, speed changed at will.

Model and constants: the planner (A) and the slowed planner clock (B) measured on ArduCopter 4.5.5;
the S-curve and the corner overlap come from `jfto_world.motion.arducopter`.
"""

from __future__ import annotations

import math
from dataclasses import replace

from jfto_sim.motion.body import Body
from jfto_sim.motion.leg import Leg, Vector
from jfto_sim.motion.shaping import LevelTarget, stopping_point
from jfto_world.motion.arducopter.leg_profile import half_overlap_s, planner_limits
from jfto_world.motion.arducopter.wpnav import Airframe, WpNav

_SHAPE_JERK_MPS3 = 5.0
# the position estimate wanders, so that a leg to where the vehicle hovers still takes 1.8 s
_WANDER_M = 0.065
_WARM_UP_STEP_S, _WARM_UP_STEPS = 0.01, 10


class WaypointNav:
    """Target along straight legs; `reached` once the destination counts as reached."""

    def __init__(self, body: Body, wpnav: WpNav) -> None:
        self.body = body
        self.wpnav = wpnav
        self.active = False
        self.reached = False
        self.fast = False
        self.destination: Vector = (0.0, 0.0, 0.0)
        self.paused = False
        self._limits = planner_limits(wpnav)
        self._previous: Leg | None = None
        self._leg: Leg | None = None
        self._next: Leg | None = None
        self._overlap_s = 0.0
        self._pace = LevelTarget(velocity_mps=[1.0, 0.0])

    def start(self, wpnav: WpNav) -> None:
        """Begin at the point where the vehicle can come to rest, with the parameters' speeds."""
        self.wpnav, self._limits = wpnav, planner_limits(wpnav)
        self.body.configure(wpnav)
        x, y, z = self.body.position_m
        vx, vy, vz = self.body.velocity_mps
        ahead = stopping_point((x, y), (vx, vy), wpnav.accel_mps2)
        self.destination = (*ahead, z + 0.5 * vz * abs(vz) / wpnav.accel_z_mps2)
        self._previous = self._leg = self._next = None
        self.fast, self.reached, self.active, self.paused = False, True, True, False
        self._pace = LevelTarget(velocity_mps=[1.0, 0.0])
        self.body.restart_clock()
        self.body.target[:] = 0.0
        self.body.target[0] = self.destination

    def begin(self, origin: Vector) -> None:
        """Begin at a point already reached (after a takeoff) instead of the stopping point."""
        self.start(self.wpnav)
        self.destination = origin

    def set_destination(self, destination: Vector, *, wander: bool = False) -> None:
        """Fly to a point; the leg begins at the last destination if that was reached.

        With `wander` a leg to where the vehicle already is has the length of the estimate's error.
        """
        if not self.active or not self.reached:
            self.start(self.wpnav)
        origin = self.destination
        if wander and math.dist(origin, destination) < _WANDER_M:
            origin = (destination[0], destination[1] - _WANDER_M, destination[2])
        following = self._next if self.fast else None
        self._previous = self._leg
        if following is not None and math.dist(following.destination, destination) < 1e-6:
            self._leg = following
        else:
            self._leg = Leg(origin, destination, self._limits)
        self._next, self._overlap_s = None, 0.0
        self.destination, self.fast, self.reached = destination, False, False

    def set_next(self, destination: Vector) -> None:
        """Say where the route goes after the present destination, which is then flown through."""
        assert self._leg is not None
        self._next = Leg(self.destination, destination, self._limits)
        self._overlap_s = self._overlap()
        self.fast = True

    def _overlap(self) -> float:
        assert self._leg is not None
        assert self._next is not None
        return float(half_overlap_s(self._leg.exit, self._next.entry, self._limits))

    def set_limits(self, wpnav: WpNav) -> None:
        """New speeds, at once also on the leg in progress."""
        self.wpnav, self._limits = wpnav, planner_limits(wpnav)
        self.body.configure(wpnav)
        for leg in (self._leg, self._next):
            if leg is not None:
                leg.change_limits(self._limits)
        if self._next is not None and self._next.elapsed_s == 0.0:
            self._overlap_s = self._overlap()

    def step(self, dt_s: float) -> None:
        """Move the target by one step and set `reached`."""
        leg = self._leg
        scale = self._pace_scale(dt_s)
        if leg is None:
            self.body.target[1:] = 0.0
            return
        advance = self.body.planner_rate * dt_s * scale
        if self._previous is not None:
            self._previous.elapsed_s += advance
        leg.elapsed_s += advance
        turning_s = 2.0 * self._overlap_s - leg.remaining_s
        if self._next is not None and self._overlap_s > 0.0 and turning_s >= 0.0:
            self._next.elapsed_s = turning_s
        self._aim(scale)
        if self.reached:
            return
        if self.fast:
            self.reached = leg.remaining_s <= self._overlap_s
        elif leg.remaining_s <= 0.0:
            away = math.dist(self.body.position_m, self.destination)
            self.reached = away <= self.wpnav.radius_m

    def _pace_scale(self, dt_s: float) -> float:
        """Share of the planned speed that is flown: 0 when paused, 1 otherwise, smoothly."""
        speed = self.wpnav.speed_mps
        self._pace.towards_velocity(
            (0.0 if self.paused else 1.0, 0.0),
            (0.0, 0.0),
            self.wpnav.accel_mps2 / speed,
            _SHAPE_JERK_MPS3 / speed,
            dt_s,
        )
        return min(1.0, max(0.0, self._pace.velocity_mps[0]))

    def _aim(self, scale: float) -> None:
        target = self.body.target
        leg = self._leg
        assert leg is not None
        first = self._previous or leg
        sums = [list(first.origin), [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]]
        for part in (self._previous, leg, self._next):
            if part is None:
                continue
            along = part.along(part.elapsed_s)
            for row in range(3):
                for axis in range(3):
                    sums[row][axis] += along[row] * part.unit[axis]
        change = self._pace.accel_mps2[0]
        for axis in range(3):
            target[0, axis] = sums[0][axis]
            target[1, axis] = sums[1][axis] * scale
            target[2, axis] = sums[2][axis] * scale * scale + sums[1][axis] * change

    @property
    def distance_m(self) -> float:
        """Horizontal distance from the vehicle to the destination."""
        x, y, _ = self.body.position_m
        return math.hypot(self.destination[0] - x, self.destination[1] - y)

    @property
    def bearing_deg(self) -> float:
        """Bearing from the vehicle to the destination, 0..360."""
        x, y, _ = self.body.position_m
        east, north = self.destination[0] - x, self.destination[1] - y
        return math.degrees(math.atan2(east, north)) % 360.0


def warm_up() -> None:
    """Fly a short leg with a corner and a change of speed on no one's account.

    The first use of the motion kernels on a machine compiles them, which takes seconds and stops
    every thread of the process: a vehicle must not fall silent for that in the air.
    """
    wpnav = WpNav()
    body = Body(Airframe(), 0.0)
    nav = WaypointNav(body, wpnav)
    body.lift_off()
    nav.begin((0.0, 0.0, 10.0))
    nav.set_destination((0.0, 40.0, 10.0))
    nav.set_next((40.0, 40.0, 20.0))
    for step in range(_WARM_UP_STEPS):
        if step == _WARM_UP_STEPS // 2:
            nav.set_limits(replace(wpnav, speed_mps=wpnav.speed_mps / 2))
        nav.step(_WARM_UP_STEP_S)
        body.fly((0.0, 0.0), _WARM_UP_STEP_S)
