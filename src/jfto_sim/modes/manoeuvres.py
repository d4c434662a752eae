"""Pieces of flying that several modes share: a moved target, and the takeoff."""

from __future__ import annotations

from jfto_sim.flight import Flight
from jfto_sim.motion.shaping import LevelTarget, VerticalTarget

_TAKEOFF_SHARE, _TAKEOFF_SLOW = 0.9, 0.1


class Mover:
    """Shared target: a horizontal part and a vertical part, written to the body."""

    def __init__(self, flight: Flight) -> None:
        self.level = LevelTarget()
        self.vertical = VerticalTarget()
        self._body = flight.body
        self._limits = flight.limits

    def reset(self) -> None:
        """Start from the body's own motion."""
        x, y, z = self._body.position_m
        vx, vy, vz = self._body.velocity_mps
        self.level.reset((x, y), (vx, vy))
        self.vertical.reset(z, vz)
        self.write()

    def write(self) -> None:
        """Hand the target to the body."""
        target = self._body.target
        for k in (0, 1):
            target[0, k] = self.level.position_m[k]
            target[1, k] = self.level.velocity_mps[k]
            target[2, k] = self.level.accel_mps2[k]
        target[0, 2] = self.vertical.height_m
        target[1, 2] = self.vertical.climb_mps
        target[2, 2] = self.vertical.accel_mps2

    def brake(self, accel_mps2: float, jerk_mps3: float, dt_s: float) -> None:
        """Come to rest horizontally."""
        self.level.towards_velocity((0.0, 0.0), (0.0, 0.0), accel_mps2, jerk_mps3, dt_s)

    def climb(self, rate_mps: float, dt_s: float) -> None:
        """Climb or sink at a rate."""
        accel_z = self._limits.wpnav.accel_z_mps2
        self.vertical.towards_climb(rate_mps, accel_z, self._limits.jerk_z_mps3, dt_s)

    def climb_to(self, height_m: float, dt_s: float, feed_mps: float = 0.0) -> None:
        """Climb or sink to a height above the power-up point that itself moves at `feed_mps`."""
        p = self._limits.wpnav
        speeds = (p.speed_up_mps, p.speed_dn_mps)
        jerk = self._limits.jerk_z_mps3
        self.vertical.towards_height(height_m, speeds, p.accel_z_mps2, jerk, dt_s, feed_mps)


class Takeoff:
    """Straight up from the ground, or from where the vehicle is, to `height_m`."""

    def __init__(self, flight: Flight) -> None:
        self.mover = Mover(flight)
        self.height_m = 0.0
        self.done = False
        self._flight = flight
        self._start_m = 0.0
        self._begins_s = 0.0

    def start(self, height_m: float) -> None:
        """`height_m` above the power-up point; never below the present height."""
        body, now = self._flight.body, self._flight.clock.time_s
        self.mover.reset()
        self._start_m = body.position_m[2]
        self.height_m = max(height_m, self._start_m)
        self._begins_s = self._flight.motors.lift_at_s() if body.landed else now
        self.done = False

    def step(self, dt_s: float) -> None:
        """Climb once the motors are up to speed."""
        if self._flight.clock.time_s < self._begins_s:
            return
        if self._flight.body.landed:
            self._flight.body.lift_off()
            self.mover.reset()
        limits, target = self._flight.limits, self.mover.vertical
        self.mover.climb_to(self.height_m, dt_s)
        self.mover.brake(limits.wpnav.accel_mps2, limits.jerk_xy_mps3, dt_s)
        self.mover.write()
        wanted = _TAKEOFF_SHARE * (self.height_m - self._start_m)
        slow = target.climb_mps < _TAKEOFF_SLOW * limits.wpnav.speed_up_mps
        if target.height_m - self._start_m >= wanted and slow:
            self.done = True
