"""GUIDED: takeoff, single goals, and streamed position, velocity and acceleration targets."""

from __future__ import annotations

import math
from enum import Enum
from typing import TYPE_CHECKING

from jfto_sim.modes.base import FlightMode, Mover, Takeoff
from jfto_sim.modes.numbers import Mode
from jfto_sim.motion.heading import YawMode
from jfto_sim.motion.waypoint_nav import WaypointNav

if TYPE_CHECKING:
    from jfto_sim.vehicle import Vehicle

Vector = tuple[float, float, float]
_STOPPED_MPS2 = 2.5


class Goal(Enum):
    """What the station last asked for."""

    NONE = "hold"
    TAKEOFF = "takeoff"
    POSITION = "position"
    MOVING = "position and velocity"
    VELOCITY = "velocity"
    ACCELERATION = "acceleration"
    WAYPOINT = "waypoint"


class Guided(FlightMode):
    """Follows targets; after GUID_TIMEOUT without one, a moving target comes to rest."""

    number = Mode.GUIDED

    def __init__(self, vehicle: Vehicle) -> None:
        super().__init__(vehicle)
        self.mover = Mover(vehicle)
        self.takeoff = Takeoff(vehicle)
        self.nav = WaypointNav(vehicle.body, vehicle.wpnav)
        self.goal = Goal.NONE
        self.position = [0.0, 0.0, 0.0]
        self.velocity = [0.0, 0.0, 0.0]
        self.accel = [0.0, 0.0, 0.0]
        self._told_s = 0.0

    def enter(self) -> bool:
        """Needs a position once armed; holds where the vehicle can stop."""
        if self.vehicle.arming.armed and not self.vehicle.position_ok:
            return False
        self.mover.reset()
        self.goal = Goal.NONE
        self.vehicle.heading.hold(self.vehicle.heading.demand_deg)
        return True

    @property
    def taking_off(self) -> bool:
        """Whether a takeoff is in progress."""
        return self.goal is Goal.TAKEOFF

    def begin_takeoff(self, height_m: float) -> None:
        """NAV_TAKEOFF: climb to a height above the power-up point."""
        self.goal = Goal.TAKEOFF
        self.takeoff.start(height_m)

    def aim(self, position: Vector | None, velocity: Vector | None, accel: Vector | None) -> None:
        """Take a new target; None for a part that the station left out."""
        before = self.goal
        if position is not None:
            moving = velocity is not None or accel is not None
            self.goal = Goal.MOVING if moving else Goal.POSITION
        elif velocity is not None:
            self.goal = Goal.VELOCITY
        else:
            self.goal = Goal.ACCELERATION
        if before is not self.goal or before in (Goal.NONE, Goal.TAKEOFF):
            self.mover.reset()
        self._told_s = self.vehicle.time_s
        if position is not None:
            self.position = list(position)
        self.velocity = list(velocity or (0.0, 0.0, 0.0))
        self.accel = list(accel or (0.0, 0.0, 0.0))
        if self.vehicle.heading.mode is YawMode.HOLD:
            self.vehicle.heading.follow_track()

    def fly_to(self, position: Vector | None) -> None:
        """GUID_OPTIONS 64: one goal by the waypoint planner, which every new goal restarts."""
        if position is None:
            return
        self.goal = Goal.WAYPOINT
        self.nav.start(self.vehicle.wpnav)
        self.nav.set_destination(position)

    def aim_yaw(self, yaw_deg: float | None, rate_dps: float | None) -> None:
        """Heading fields of a target message."""
        heading = self.vehicle.heading
        if yaw_deg is not None:
            heading.stream(yaw_deg, rate_dps or 0.0)
        elif rate_dps is not None:
            heading.set_rate(rate_dps)
        elif heading.mode is not YawMode.FIXED:
            heading.follow_track()

    def step(self, dt_s: float) -> None:
        """Move the target."""
        if self.goal is Goal.TAKEOFF:
            self.takeoff.step(dt_s)
            if self.takeoff.done:
                self.mover.reset()
                self.position = [*self.body.position_m[:2], self.takeoff.height_m]
                self.mover.vertical.reset(self.takeoff.mover.vertical.height_m)
                self.goal = Goal.POSITION
            return
        if self.body.landed:
            return
        if self.goal is Goal.WAYPOINT:
            self.nav.step(dt_s)
            return
        stale = self.vehicle.time_s - self._told_s > self.vehicle.params["GUID_TIMEOUT"]
        if stale and self.goal in (Goal.MOVING, Goal.VELOCITY, Goal.ACCELERATION):
            self.velocity, self.accel = [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]
        self._level(dt_s)
        self._vertical(dt_s)
        self.mover.write()

    def _level(self, dt_s: float) -> None:
        v, level = self.vehicle, self.mover.level
        p = v.wpnav
        limits = (p.speed_mps, p.accel_mps2, v.jerk_xy_mps3)
        velocity, accel = self.velocity, self.accel
        if self.goal is Goal.NONE:
            self.mover.brake(_STOPPED_MPS2, v.jerk_xy_mps3, dt_s)
        elif self.goal in (Goal.POSITION, Goal.MOVING):
            for k in (0, 1):
                self.position[k] += dt_s * (velocity[k] + 0.5 * dt_s * accel[k])
                velocity[k] += dt_s * accel[k]
            aim = (self.position[0], self.position[1])
            feed = ((velocity[0], velocity[1]), (accel[0], accel[1]))
            level.towards_position(aim, feed, limits, dt_s)
        else:
            for k in (0, 1):
                velocity[k] += dt_s * accel[k]
            level.towards_velocity(
                (velocity[0], velocity[1]), (accel[0], accel[1]), *limits[1:], dt_s
            )

    def _vertical(self, dt_s: float) -> None:
        v, vertical = self.vehicle, self.mover.vertical
        p = v.wpnav
        if self.goal in (Goal.POSITION, Goal.MOVING):
            self.position[2] += dt_s * (self.velocity[2] + 0.5 * dt_s * self.accel[2])
            self.velocity[2] += dt_s * self.accel[2]
            vertical.towards_height(
                self.position[2],
                (p.speed_up_mps, p.speed_dn_mps),
                p.accel_z_mps2,
                v.jerk_z_mps3,
                dt_s,
                self.velocity[2],
            )
            return
        self.velocity[2] += dt_s * self.accel[2]
        rate = 0.0 if self.goal is Goal.NONE else self.velocity[2]
        vertical.towards_climb(rate, p.accel_z_mps2, v.jerk_z_mps3, dt_s)

    @property
    def distance_m(self) -> float:
        """Horizontal distance to the goal."""
        x, y, _ = self.body.position_m
        if self.goal not in (Goal.POSITION, Goal.MOVING):
            return 0.0
        return math.hypot(self.position[0] - x, self.position[1] - y)
