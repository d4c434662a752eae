"""Parameters of ArduCopter's waypoint planner and of the airframe that follows it."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields, replace

from jfto_msgs_py.errors import InputError
from jfto_world.motion.limits import MotionLimits

GRAVITY_MPS2 = 9.80665


@dataclass(frozen=True)
class WpNav:
    """ArduCopter's WPNAV_*, ATC_INPUT_TC and ANGLE_MAX in SI units; the values are its defaults.

    `corner_accel_mps2` = 0 means twice the horizontal acceleration, as WPNAV_ACCEL_C = 0 does.
    """

    speed_mps: float = 10.0
    speed_up_mps: float = 2.5
    speed_dn_mps: float = 1.5
    accel_mps2: float = 2.5
    accel_z_mps2: float = 1.0
    corner_accel_mps2: float = 0.0
    jerk_mps3: float = 1.0
    radius_m: float = 2.0
    input_tc_s: float = 0.15
    angle_max_deg: float = 30.0

    def __post_init__(self) -> None:
        for entry in fields(self):
            value = getattr(self, entry.name)
            least_allowed = entry.name == "corner_accel_mps2" and value == 0
            if not ((value > 0 and math.isfinite(value)) or least_allowed):
                raise InputError(f"{entry.name} is {value}, must be positive.")
        if self.angle_max_deg >= 90:
            raise InputError(f"angle_max_deg is {self.angle_max_deg}, must be below 90.")

    @property
    def corner_limit_mps2(self) -> float:
        """Greatest horizontal acceleration that a corner may ask for, m/s²."""
        return self.corner_accel_mps2 or 2.0 * self.accel_mps2

    @property
    def tilt_accel_mps2(self) -> float:
        """Greatest horizontal acceleration that the tilt limit allows, m/s²."""
        return GRAVITY_MPS2 * math.tan(math.radians(self.angle_max_deg))

    def within(self, limits: MotionLimits) -> WpNav:
        """The same parameters with the three speeds taken from a vehicle's limits."""
        return replace(
            self,
            speed_mps=limits.speed_mps,
            speed_up_mps=limits.climb_mps,
            speed_dn_mps=limits.descent_mps,
        )

    def as_parameters(self) -> dict[str, float]:
        """The autopilot's parameters (cm, degrees · 100) that make it fly as modelled."""
        return {
            "WPNAV_SPEED": 100.0 * self.speed_mps,
            "WPNAV_SPEED_UP": 100.0 * self.speed_up_mps,
            "WPNAV_SPEED_DN": 100.0 * self.speed_dn_mps,
            "WPNAV_ACCEL": 100.0 * self.accel_mps2,
            "WPNAV_ACCEL_Z": 100.0 * self.accel_z_mps2,
            "WPNAV_ACCEL_C": 100.0 * self.corner_accel_mps2,
            "WPNAV_JERK": self.jerk_mps3,
            "WPNAV_RADIUS": 100.0 * self.radius_m,
            "ATC_INPUT_TC": self.input_tc_s,
            "ANGLE_MAX": 100.0 * self.angle_max_deg,
        }


@dataclass(frozen=True)
class Airframe:
    """What is specific to a vehicle: drag, and how fast it answers.

    Drag deceleration is drag_linear · v in all directions plus drag_quadratic · |v| v along and
    across the nose, v the velocity through the air. The defaults fit ArduCopter 4.5's simulated
    quadcopter within 2 % of its steady tilt between 3 and 10 m/s.
    """

    drag_linear_1ps: float = 0.245
    drag_quadratic_1pm: float = 0.0314
    attitude_lag_s: float = 0.06
    climb_lag_s: float = 0.3

    def __post_init__(self) -> None:
        for name in ("attitude_lag_s", "climb_lag_s"):
            if not getattr(self, name) > 0:
                raise InputError(f"{name} is {getattr(self, name)}, must be positive.")
        for name in ("drag_linear_1ps", "drag_quadratic_1pm"):
            if not getattr(self, name) >= 0:
                raise InputError(f"{name} is {getattr(self, name)}, must not be negative.")

    def drag_mps2(self, airspeed_mps: float) -> float:
        """Deceleration by drag at an airspeed from ahead, m/s²."""
        return (self.drag_linear_1ps + self.drag_quadratic_1pm * airspeed_mps) * airspeed_mps

    def top_airspeed_mps(self, wpnav: WpNav) -> float:
        """Level airspeed that the tilt limit can just hold, m/s (infinite without drag)."""
        linear, quadratic = self.drag_linear_1ps, self.drag_quadratic_1pm
        if quadratic == 0:
            return wpnav.tilt_accel_mps2 / linear if linear > 0 else math.inf
        root = math.sqrt(linear**2 + 4.0 * quadratic * wpnav.tilt_accel_mps2)
        return (root - linear) / (2.0 * quadratic)
