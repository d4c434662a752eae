"""Parameters of ArduCopter's waypoint planner and of the airframe that follows it."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields, replace

from jfto_msgs_py.errors import InputError
from jfto_msgs_py.units import GRAVITY_MPS2
from jfto_world.motion.time_model import MotionLimits

_THRUST_ROUNDS = 30


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
            "WPNAV_SPEED": _centi(self.speed_mps),
            "WPNAV_SPEED_UP": _centi(self.speed_up_mps),
            "WPNAV_SPEED_DN": _centi(self.speed_dn_mps),
            "WPNAV_ACCEL": _centi(self.accel_mps2),
            "WPNAV_ACCEL_Z": _centi(self.accel_z_mps2),
            "WPNAV_ACCEL_C": _centi(self.corner_accel_mps2),
            "WPNAV_JERK": self.jerk_mps3,
            "WPNAV_RADIUS": _centi(self.radius_m),
            "ATC_INPUT_TC": self.input_tc_s,
            "ANGLE_MAX": round(100.0 * self.angle_max_deg),
        }


def _centi(value: float) -> float:
    """Hundredths without the dust of binary fractions."""
    return round(100.0 * value, 6)


@dataclass(frozen=True)
class Airframe:
    """What is specific to a vehicle: drag, and how fast it answers.

    Drag deceleration along each body axis is drag_linear · (thrust / weight)^(1/2) · v, of the
    rotors, plus drag_quadratic · |v| v, of the body, v being the velocity through the air along
    the axis. The defaults fit ArduCopter 4.5's simulated quadcopter: 20° hold 7.4 m/s.
    """

    drag_linear_1ps: float = 0.2416
    drag_quadratic_1pm: float = 0.0331
    attitude_lag_s: float = 0.03
    climb_lag_s: float = 0.3

    def __post_init__(self) -> None:
        for name in ("attitude_lag_s", "climb_lag_s"):
            if not getattr(self, name) > 0:
                raise InputError(f"{name} is {getattr(self, name)}, must be positive.")
        for name in ("drag_linear_1ps", "drag_quadratic_1pm"):
            if not getattr(self, name) >= 0:
                raise InputError(f"{name} is {getattr(self, name)}, must not be negative.")

    def top_airspeed_mps(self, wpnav: WpNav) -> float:
        """Level airspeed that the tilt limit can just hold, m/s (infinite without drag)."""
        linear, quadratic = self.drag_linear_1ps, self.drag_quadratic_1pm
        if linear == 0 and quadratic == 0:
            return math.inf
        tilt = math.radians(wpnav.angle_max_deg)
        sine, cosine = math.sin(tilt), math.cos(tilt)
        thrust, speed = GRAVITY_MPS2, 0.0
        # thrust is weight and drag along the rotor axis; it changes the rotors' drag a little
        for _ in range(_THRUST_ROUNDS):
            rotors = linear * math.sqrt(thrust / GRAVITY_MPS2)
            # the root of quadratic (v cos)² + rotors (v cos) = g sin that keeps its digits
            root = math.sqrt(rotors**2 + 4.0 * quadratic * GRAVITY_MPS2 * sine)
            speed = 2.0 * GRAVITY_MPS2 * sine / (rotors + root) / cosine
            through = speed * sine
            thrust = GRAVITY_MPS2 * cosine + through * (rotors + quadratic * through)
        return speed
