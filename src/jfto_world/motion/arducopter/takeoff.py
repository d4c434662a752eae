"""The climb from the pad that NAV_TAKEOFF flies before the first leg.

The autopilot speeds up with WPNAV_ACCEL_Z, climbs at WPNAV_SPEED_UP, and brakes with half of that
acceleration, since it approaches a height by a square root of the distance left; for the last bit
its speed falls off exponentially. The item is done once it climbs slower than a tenth of
WPNAV_SPEED_UP. Measured on ArduCopter 4.5 at the defaults, from 20, 40 and 60 m: done 4.0 s +
height / climb speed after the mission's start, off the ground 1.8 s after it. Times here start
there.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from jfto_msgs_py.types import Array

SPOOL_UP_S = 1.8
# The target leaves the pad so long before the vehicle does, which catches up: as measured.
_HEAD_START_S = 1.1
# PSC_JERK_Z, the share of the acceleration for braking, and the end of the item, as released.
_JERK_MPS3 = 5.0
_BRAKING_SHARE = 0.5
_SLOW_SHARE = 0.1


def takeoff_s(height_m: float, climb_mps: float, accel_mps2: float) -> float:
    """Seconds from lift-off until the first leg begins; 0 for no height.

    Climb speed and acceleration are WPNAV_SPEED_UP and WPNAV_ACCEL_Z in m/s and m/s².
    """
    if height_m <= 0:
        return 0.0
    climb = _climb(height_m, climb_mps, accel_mps2)
    return climb.total_s - climb.head_start_s


def takeoff_height_m(height_m: float, climb_mps: float, accel_mps2: float, times_s: Array) -> Array:
    """Height above the pad at times since lift-off, (T,)."""
    times = np.asarray(times_s, dtype=np.float64)
    if height_m <= 0:
        return np.zeros_like(times)
    climb = _climb(height_m, climb_mps, accel_mps2)
    # The vehicle catches up with the target on its way.
    since = np.clip(times, 0.0, None) * climb.total_s / (climb.total_s - climb.head_start_s)
    since = np.minimum(since, climb.total_s)
    climbed: Array = climb.height_m(since) * height_m / climb.height_m(np.array(climb.total_s))
    return climbed


@dataclass(frozen=True)
class _Climb:
    """The target's climb at `peak_mps`: speeding up, steady, braking, falling off."""

    peak_mps: float
    slow_mps: float
    accel_mps2: float
    steady_m: float

    @property
    def braking_mps2(self) -> float:
        return _BRAKING_SHARE * self.accel_mps2

    @property
    def gain(self) -> float:
        """Of the speed over the height left, near the end, 1/s."""
        return 0.5 * _JERK_MPS3 / self.accel_mps2

    @property
    def soft_mps(self) -> float:
        """Speed at which braking ends."""
        return min(max(self.braking_mps2 / self.gain, self.slow_mps), self.peak_mps)

    @property
    def rise_s(self) -> float:
        return self.peak_mps / self.accel_mps2 + 0.5 * self.accel_mps2 / _JERK_MPS3

    @property
    def brake_s(self) -> float:
        return (self.peak_mps - self.soft_mps) / self.braking_mps2

    @property
    def total_s(self) -> float:
        soft_s = math.log(self.soft_mps / self.slow_mps) / self.gain
        return self.rise_s + self.steady_m / self.peak_mps + self.brake_s + soft_s

    @property
    def head_start_s(self) -> float:
        return min(_HEAD_START_S, 0.5 * self.total_s)

    def height_m(self, since_s: Array) -> Array:
        """Height of the target at times since it left the pad."""
        rising = np.minimum(since_s, self.rise_s)
        steady_s = self.steady_m / self.peak_mps
        steady = np.clip(since_s - self.rise_s, 0.0, steady_s)
        braking = np.clip(since_s - self.rise_s - steady_s, 0.0, self.brake_s)
        soft = np.maximum(since_s - self.rise_s - steady_s - self.brake_s, 0.0)
        height: Array = (
            0.5 * self.peak_mps * rising**2 / self.rise_s
            + self.peak_mps * (steady + braking)
            - 0.5 * self.braking_mps2 * braking**2
            + self.soft_mps / self.gain * (1.0 - np.exp(-self.gain * soft))
        )
        return height


def _climb(height_m: float, climb_mps: float, accel_mps2: float) -> _Climb:
    """The climb to a height; where that is low its peak speed is below `climb_mps`."""

    def moving_m(peak_mps: float) -> float:
        """Height of speeding up and braking to rest."""
        climb = _Climb(peak_mps, slow_mps, accel_mps2, 0.0)
        soft_m = climb.soft_mps / climb.gain if climb.soft_mps > slow_mps else 0.0
        brake_m = 0.5 * (peak_mps**2 - climb.soft_mps**2) / climb.braking_mps2
        rest_m = 0.5 * slow_mps**2 / climb.braking_mps2 if not soft_m else 0.0
        return 0.5 * peak_mps * climb.rise_s + brake_m + soft_m + rest_m

    slow_mps = _SLOW_SHARE * climb_mps
    peak_mps = climb_mps
    if moving_m(peak_mps) > height_m:
        low, peak_mps = slow_mps, climb_mps
        while peak_mps - low > 1e-9 * climb_mps:
            middle = 0.5 * (low + peak_mps)
            low, peak_mps = (middle, peak_mps) if moving_m(middle) < height_m else (low, middle)
    steady_m = max(height_m - moving_m(peak_mps), 0.0)
    return _Climb(peak_mps, slow_mps, accel_mps2, steady_m)
