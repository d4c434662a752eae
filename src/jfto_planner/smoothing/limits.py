"""What a trajectory may ask of its vehicle and its camera, and what time that takes at least."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields

import numpy as np

from jfto_msgs_py.errors import InputError
from jfto_msgs_py.types import Array
from jfto_msgs_py.units import GRAVITY_MPS2
from jfto_world.motion.time_model import MotionLimits


@dataclass(frozen=True)
class CurveLimits:
    """Limits of speed, acceleration, jerk and tilt along a trajectory.

    `speed_mps` and `accel_mps2` bound the horizontal parts, `climb_mps`, `descent_mps` and
    `accel_z_mps2` the vertical ones, `jerk_mps3` the whole jerk. `tilt_deg` bounds the angle of
    the thrust that acceleration, gravity and linear drag (`drag_1ps` · velocity) need.
    """

    speed_mps: float
    climb_mps: float
    descent_mps: float
    accel_mps2: float = 3.5
    accel_z_mps2: float = 2.0
    jerk_mps3: float = 5.0
    tilt_deg: float = 30.0
    drag_1ps: float = 0.0

    def __post_init__(self) -> None:
        for entry in fields(self):
            value = getattr(self, entry.name)
            if not (
                math.isfinite(value) and (value > 0 or (entry.name == "drag_1ps" and value == 0))
            ):
                raise InputError(f"{entry.name} is {value}, must be positive and finite.")
        if self.tilt_deg >= 90:
            raise InputError(f"tilt_deg is {self.tilt_deg}, must be below 90.")
        cruise = math.degrees(math.atan(self.drag_1ps * self.speed_mps / GRAVITY_MPS2))
        if cruise >= self.tilt_deg:
            raise InputError(
                f"speed_mps {self.speed_mps} needs {cruise:.1f}° of tilt against drag, more than "
                f"tilt_deg {self.tilt_deg}; lower the speed or raise the tilt."
            )

    @classmethod
    def of(cls, motion: MotionLimits, **others: float) -> CurveLimits:
        """Limits with the three speeds of `motion`; `others` as the fields."""
        return cls(motion.speed_mps, motion.climb_mps, motion.descent_mps, **others)

    def row(self, margin: float = 0.0) -> Array:
        """The limits lowered by `margin` as the row of 8 numbers for compiled functions."""
        kept = 1.0 - margin
        return np.array(
            [
                kept * self.speed_mps,
                kept * self.climb_mps,
                kept * self.descent_mps,
                kept * self.accel_mps2,
                kept * self.accel_z_mps2,
                kept * self.jerk_mps3,
                kept * math.tan(math.radians(self.tilt_deg)),
                self.drag_1ps,
            ]
        )


def photo_speed_mps(gsd_m: float, blur_px: float, exposure_s: float) -> float:
    """Fastest pass over a photo point: the image moves `blur_px` pixels during the exposure.

    Parameters
    ----------
    gsd_m
        Ground resolution, m per pixel.
    blur_px
        Greatest blur, pixels.
    exposure_s
        Exposure, s.

    Returns
    -------
    float
        Speed, m/s.

    Raises
    ------
    InputError
        An argument is not positive.
    """
    for name, value in (("gsd_m", gsd_m), ("blur_px", blur_px), ("exposure_s", exposure_s)):
        if not value > 0:
            raise InputError(f"{name} is {value}, must be positive.")
    return gsd_m * blur_px / exposure_s


def rest_to_rest_s(length_m: float, speed_mps: float, accel_mps2: float, jerk_mps3: float) -> float:
    """Least duration of one quintic segment from rest to rest along a straight line.

    T = max(1.875 L/v, sqrt(10/sqrt(3) L/a), (60 L/j)^(1/3)): the position 10 s³ - 15 s⁴ + 6 s⁵ has
    these peaks of speed, acceleration and jerk.

    Parameters
    ----------
    length_m
        L, m.
    speed_mps
        v, m/s.
    accel_mps2
        a, m/s².
    jerk_mps3
        j, m/s³.

    Returns
    -------
    float
        T, s.
    """
    return max(
        1.875 * length_m / speed_mps,
        math.sqrt(10.0 / math.sqrt(3.0) * length_m / accel_mps2),
        (60.0 * length_m / jerk_mps3) ** (1.0 / 3.0),
    )
