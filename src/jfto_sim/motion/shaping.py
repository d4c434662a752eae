"""Jerk-limited target motion towards a goal that may itself move, as the autopilot shapes it.

Names follow ArduPilot's AP_Math control functions: a square-root controller turns a position
error into a speed that the acceleration can still brake, another one turns the speed error into
an acceleration, and the jerk limits how fast that acceleration changes.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

# positions are approached with half of the acceleration that is allowed
_BRAKING_SHARE = 0.5


def sqrt_controller(error: float, gain: float, limit: float, dt_s: float) -> float:
    """First-order correction of an error whose rate of change is limited by `limit`."""
    size = abs(error)
    linear = limit / (gain * gain) if gain > 0 else 0.0
    rate = math.sqrt(2.0 * limit * (size - 0.5 * linear)) if size > linear else size * gain
    return math.copysign(min(rate, size / dt_s), error)


def _clamp(value: float, low: float, high: float) -> float:
    return min(high, max(low, value))


@dataclass
class VerticalTarget:
    """Height, climb rate and acceleration asked of the vehicle, in metres up."""

    height_m: float = 0.0
    climb_mps: float = 0.0
    accel_mps2: float = 0.0

    def reset(self, height_m: float, climb_mps: float = 0.0) -> None:
        """Start again from the vehicle's own height and climb."""
        self.height_m, self.climb_mps, self.accel_mps2 = height_m, climb_mps, 0.0

    def towards_climb(
        self, climb_mps: float, accel_mps2: float, jerk_mps3: float, dt_s: float
    ) -> None:
        """One step towards a climb rate."""
        gain = jerk_mps3 / accel_mps2
        wanted = sqrt_controller(climb_mps - self.climb_mps, gain, jerk_mps3, dt_s)
        wanted = _clamp(wanted, -accel_mps2, accel_mps2)
        step = jerk_mps3 * dt_s
        self.accel_mps2 += _clamp(wanted - self.accel_mps2, -step, step)
        self.height_m += self.climb_mps * dt_s + 0.5 * self.accel_mps2 * dt_s * dt_s
        self.climb_mps += self.accel_mps2 * dt_s

    def towards_height(
        self,
        height_m: float,
        limits: tuple[float, float],
        accel_mps2: float,
        jerk_mps3: float,
        dt_s: float,
        feed_mps: float = 0.0,
    ) -> None:
        """One step towards a height; `limits` are the greatest (climb, sink) rates."""
        gain = 0.5 * jerk_mps3 / accel_mps2
        braking = _BRAKING_SHARE * accel_mps2
        climb = sqrt_controller(height_m - self.height_m, gain, braking, dt_s)
        climb = _clamp(climb, -limits[1], limits[0]) + feed_mps
        self.towards_climb(climb, accel_mps2, jerk_mps3, dt_s)


@dataclass
class LevelTarget:
    """Horizontal position, velocity and acceleration asked of the vehicle, (east, north)."""

    position_m: list[float] = field(default_factory=lambda: [0.0, 0.0])
    velocity_mps: list[float] = field(default_factory=lambda: [0.0, 0.0])
    accel_mps2: list[float] = field(default_factory=lambda: [0.0, 0.0])

    def reset(self, position_m: tuple[float, float], velocity_mps: tuple[float, float]) -> None:
        """Start again from the vehicle's own position and velocity."""
        self.position_m, self.velocity_mps = list(position_m), list(velocity_mps)
        self.accel_mps2 = [0.0, 0.0]

    def towards_velocity(
        self,
        velocity_mps: tuple[float, float],
        feed_mps2: tuple[float, float],
        accel_mps2: float,
        jerk_mps3: float,
        dt_s: float,
    ) -> None:
        """One step towards a velocity, with an acceleration fed forward."""
        error = [velocity_mps[k] - self.velocity_mps[k] for k in (0, 1)]
        size = math.hypot(*error)
        wanted = [0.0, 0.0]
        if size > 1e-9:
            push = sqrt_controller(size, jerk_mps3 / accel_mps2, jerk_mps3, dt_s)
            push = min(push, accel_mps2)
            wanted = [push * e / size for e in error]
        change = [wanted[k] + feed_mps2[k] - self.accel_mps2[k] for k in (0, 1)]
        size, step = math.hypot(*change), jerk_mps3 * dt_s
        scale = step / size if size > step else 1.0
        for k in (0, 1):
            self.accel_mps2[k] += change[k] * scale
            self.position_m[k] += dt_s * (self.velocity_mps[k] + 0.5 * dt_s * self.accel_mps2[k])
            self.velocity_mps[k] += dt_s * self.accel_mps2[k]

    def towards_position(
        self,
        position_m: tuple[float, float],
        feed: tuple[tuple[float, float], tuple[float, float]],
        limits: tuple[float, float, float],
        dt_s: float,
    ) -> None:
        """One step towards a position that moves with `feed` = (velocity, acceleration).

        `limits` are the greatest speed of the correction, acceleration and jerk.
        """
        speed_mps, accel_mps2, jerk_mps3 = limits
        error = [position_m[k] - self.position_m[k] for k in (0, 1)]
        size = math.hypot(*error)
        velocity = [0.0, 0.0]
        if size > 1e-9:
            gain = 0.5 * jerk_mps3 / accel_mps2
            braking = _BRAKING_SHARE * accel_mps2
            rate = min(sqrt_controller(size, gain, braking, dt_s), speed_mps)
            velocity = [rate * e / size for e in error]
        aim = (velocity[0] + feed[0][0], velocity[1] + feed[0][1])
        self.towards_velocity(aim, feed[1], accel_mps2, jerk_mps3, dt_s)


def stopping_point(
    position_m: tuple[float, float], velocity_mps: tuple[float, float], accel_mps2: float
) -> tuple[float, float]:
    """Where the vehicle can come to rest: the distance at which braking begins, ahead of it."""
    speed = math.hypot(*velocity_mps)
    if speed < 0.1:
        return position_m
    braking_m = 0.5 * accel_mps2 + speed * speed / (2.0 * accel_mps2)
    distance = speed if speed < accel_mps2 else braking_m
    return (
        position_m[0] + distance * velocity_mps[0] / speed,
        position_m[1] + distance * velocity_mps[1] / speed,
    )
