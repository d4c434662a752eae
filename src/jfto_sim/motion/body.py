"""The flying body: position, velocity, tilt and heading, stepped towards a target."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from jfto_msgs_py.units import GRAVITY_MPS2
from jfto_sim.geodesy import wrap_180, wrap_360
from jfto_world.motion.arducopter.follower import (
    HEADING,
    RATE,
    THRUST,
    clock_step,
    follow_step,
    follower_parameters,
    hover_state,
)
from jfto_world.motion.arducopter.wpnav import Airframe, WpNav

_YAW_LAG_S = 0.3
_FALL_MPS2 = 6.2  # net downward acceleration measured with one motor at a fifth of its thrust
_TUMBLE_DEG = 60.0
_INTO_SLOPE_M = 1.0  # deeper than this it has flown into rising ground, climbing or not


class Body:
    """State of the airframe in metres east, north, up of home, and its heading.

    `thrust` is what its rotors give, in weights: more in a climb, a turn or a strong wind.
    `target` is (3, 3): position, velocity and acceleration asked for. `landed` means that it
    stands on the ground: `ground` gives its height at metres east and north of the power-up point;
    without it the ground is flat at that point's height.
    """

    def __init__(
        self,
        airframe: Airframe,
        heading_deg: float,
        ground: Callable[[float, float], float] | None = None,
    ) -> None:
        self.airframe = airframe
        self._ground = ground
        self.state = hover_state(np.zeros(3))
        self.target = np.zeros((3, 3))
        self.yaw_deg = wrap_360(heading_deg)
        self.yaw_rate_dps = 0.0
        self.landed = True
        self.failed = False
        self.failed_for_s = 0.0
        self.hit_ground_mps = 0.0
        self.thrust = 0.0
        self._parameters = follower_parameters(WpNav(), airframe)

    def configure(self, wpnav: WpNav) -> None:
        """Take new limits for tilt and the planner's clock."""
        self._parameters = follower_parameters(wpnav, self.airframe)

    @property
    def position_m(self) -> tuple[float, float, float]:
        """East, north, up of the power-up point."""
        return float(self.state[0]), float(self.state[1]), float(self.state[2])

    @property
    def velocity_mps(self) -> tuple[float, float, float]:
        """Velocity east, north, up."""
        return float(self.state[3]), float(self.state[4]), float(self.state[5])

    @property
    def attitude_deg(self) -> tuple[float, float]:
        """Roll and pitch that make the horizontal acceleration now in force."""
        if self.failed and not self.landed:
            return _TUMBLE_DEG * min(1.0, self.failed_for_s), -_TUMBLE_DEG * 0.5
        if self.landed:
            return 0.0, 0.0
        east, north = float(self.state[THRUST]), float(self.state[THRUST + 1])
        yaw = math.radians(self.yaw_deg)
        forward = north * math.cos(yaw) + east * math.sin(yaw)
        right = east * math.cos(yaw) - north * math.sin(yaw)
        pitch = -math.degrees(math.atan2(forward, GRAVITY_MPS2))
        roll = math.degrees(math.atan2(right, GRAVITY_MPS2))
        return roll, pitch

    def rest(self) -> None:
        """Forget velocity, tilt and integrators: the vehicle stands on the ground."""
        self.state = hover_state(self.state[:3], self.yaw_deg)

    def restart_clock(self) -> None:
        """Let the planner's clock run at full rate again."""
        self.state[RATE] = 1.0

    @property
    def planner_rate(self) -> float:
        """Rate of the planner's clock: less than 1 while the vehicle lags behind."""
        return float(self.state[RATE])

    def turn(self, wanted_deg: float, rate_dps: float, dt_s: float) -> None:
        """Turn towards a heading; `rate_dps` is fed forward."""
        before = self.yaw_deg
        error = wrap_180(wanted_deg - self.yaw_deg)
        share = 1.0 - math.exp(-dt_s / _YAW_LAG_S)
        self.yaw_deg = wrap_360(self.yaw_deg + error * share + rate_dps * dt_s * (1.0 - share))
        self.yaw_rate_dps = wrap_180(self.yaw_deg - before) / dt_s
        yaw = math.radians(self.yaw_deg)
        self.state[HEADING], self.state[HEADING + 1] = math.sin(yaw), math.cos(yaw)

    def fly(self, wind_mps: tuple[float, float], dt_s: float) -> None:
        """One step in the air; touching the ground ends it."""
        if self.failed:
            self._fall(dt_s)
        else:
            climb_mps = float(self.state[5])
            clock_step(self.state, self.target, self._parameters, dt_s)
            follow_step(self.state, self.target, self._parameters, wind_mps[0], wind_mps[1], dt_s)
            self._note_thrust(wind_mps, (float(self.state[5]) - climb_mps) / dt_s)
        floor_m = 0.0
        if self._ground is not None:
            floor_m = self._ground(float(self.state[0]), float(self.state[1]))
        depth_m = floor_m - float(self.state[2])
        if depth_m >= 0.0 and (self.state[5] <= 0.0 or depth_m > _INTO_SLOPE_M):
            self.hit_ground_mps = abs(float(self.state[5]))
            self.state[2] = floor_m
            self.rest()
            self.landed = True

    def _note_thrust(self, wind_mps: tuple[float, float], climb_mps2: float) -> None:
        """Weight, drag and acceleration along the vertical, carried by a tilted thrust.

        Drag ahead of the tilted body carries part of the weight, that along its axis adds to it.
        """
        frame, (vx, vy, vz) = self.airframe, self.velocity_mps
        lean_e, lean_n = float(self.state[THRUST]), float(self.state[THRUST + 1])
        lean = math.hypot(lean_e, lean_n)
        size = math.hypot(lean, GRAVITY_MPS2)
        sine, cosine = lean / size, GRAVITY_MPS2 / size
        # speed through the air in the direction of the lean
        air = ((vx - wind_mps[0]) * lean_e + (vy - wind_mps[1]) * lean_n) / max(lean, 1e-9)
        ahead, axial = air * cosine - vz * sine, air * sine + vz * cosine
        drag_ahead, drag_axial = (
            v * (frame.drag_linear_1ps + frame.drag_quadratic_1pm * abs(v)) for v in (ahead, axial)
        )
        carried = GRAVITY_MPS2 + climb_mps2 - drag_ahead * sine + drag_axial * cosine
        self.thrust = max(0.0, carried / cosine / GRAVITY_MPS2)

    def _fall(self, dt_s: float) -> None:
        self.failed_for_s += dt_s
        self.state[5] -= _FALL_MPS2 * dt_s
        self.state[:3] += self.state[3:6] * dt_s

    def lift_off(self) -> None:
        """Leave the ground with nothing wound up."""
        self.landed = False
        self.failed_for_s = 0.0
        self.rest()
