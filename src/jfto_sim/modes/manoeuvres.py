"""Pieces of flying that several modes share: a moved target, takeoff, landing, return home."""

from __future__ import annotations

import math
from enum import Enum

from jfto_sim.flight import Flight
from jfto_sim.motion.shaping import LevelTarget, VerticalTarget, sqrt_controller
from jfto_sim.motion.waypoint_nav import WaypointNav

_TAKEOFF_SHARE, _TAKEOFF_SLOW = 0.9, 0.1
_LAND_GAIN = 1.0
_CONE_CLIMB_MIN_M = 2.0
_HEADING_KEPT = (0, 2)  # WP_YAW_BEHAVIOR


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


class Descent:
    """Vertical landing at the speeds of LAND_*; touchdown is the body's business."""

    def __init__(self, flight: Flight) -> None:
        self._flight = flight
        self._mover = Mover(flight)
        self._place_m: tuple[float, float] | None = None

    def start(self, place_m: tuple[float, float] | None = None) -> None:
        """Land where the vehicle can stop, or at a place."""
        self._mover.reset()
        self._place_m = place_m
        self._flight.heading.hold()

    def step(self, dt_s: float, *, hold: bool = False) -> None:
        """Sink: fast above LAND_ALT_LOW, then at LAND_SPEED; or hold the height for now."""
        params, limits = self._flight.params, self._flight.limits
        p, jerk = limits.wpnav, limits.jerk_xy_mps3
        low_m = params["LAND_ALT_LOW"] / 100.0
        fast = params["LAND_SPEED_HIGH"] / 100.0 or p.speed_dn_mps
        slow = params["LAND_SPEED"] / 100.0
        above = low_m - self._flight.position.from_home_m[2]
        rate = sqrt_controller(above, _LAND_GAIN, p.accel_z_mps2, dt_s)
        self._mover.climb(0.0 if hold else max(-max(fast, slow), min(-slow, rate)), dt_s)
        if self._place_m is None:
            self._mover.brake(p.accel_mps2, jerk, dt_s)
        else:
            still = ((0.0, 0.0), (0.0, 0.0))
            self._mover.level.towards_position(
                self._place_m, still, (p.speed_mps, p.accel_mps2, jerk), dt_s
            )
        self._mover.write()


class _Stage(Enum):
    CLIMB = 1
    RETURN = 2
    WAIT = 3
    LAND = 4


class ReturnHome:
    """Up to RTL_ALT if lower, home in a straight line, wait, land."""

    def __init__(self, flight: Flight) -> None:
        self.nav = WaypointNav(flight.body, flight.limits.wpnav)
        self._flight = flight
        self._descent = Descent(flight)
        self._stage = _Stage.CLIMB
        self._height_m = 0.0
        self._waits_since_s = 0.0

    def start(self) -> None:
        """From the point where the vehicle can stop."""
        flight = self._flight
        self.nav.start(flight.limits.at(flight.params["RTL_SPEED"]))
        x, y, z = self.nav.destination
        home = flight.position.home_m
        self._height_m = self._return_height(math.dist((x, y), home[:2]), z - home[2]) + home[2]
        self.nav.set_destination((x, y, self._height_m))
        self.nav.set_next((home[0], home[1], self._height_m))
        self._stage = _Stage.CLIMB
        flight.heading.hold()

    def _return_height(self, distance_m: float, height_m: float) -> float:
        p = self._flight.params
        wanted = max(height_m + p["RTL_CLIMB_MIN"] / 100.0, p["RTL_ALT"] / 100.0, height_m)
        slope = p["RTL_CONE_SLOPE"]
        if slope > 0:
            cone = max(distance_m * slope, _CONE_CLIMB_MIN_M)
            wanted = max(height_m, min(wanted, cone))
        return wanted

    def step(self, dt_s: float) -> None:
        """Move the target and go on to the next stage when one is done."""
        if self._stage is _Stage.LAND:
            self._descent.step(dt_s)
            return
        self.nav.step(dt_s)
        params, position = self._flight.params, self._flight.position
        now, home = self._flight.clock.time_s, position.home_m
        waited_s = now - self._waits_since_s
        if self._stage is _Stage.CLIMB and self.nav.reached:
            self.nav.set_destination((home[0], home[1], self._height_m))
            self._stage = _Stage.RETURN
        elif self._stage is _Stage.RETURN and self.nav.reached:
            self._waits_since_s = now
            self._stage = _Stage.WAIT
            if int(params["WP_YAW_BEHAVIOR"]) not in _HEADING_KEPT:
                heading = self._flight.heading
                heading.turn_to(position.home_heading_deg, 0.0, 0, relative=False)
        elif self._stage is _Stage.WAIT and waited_s >= params["RTL_LOIT_TIME"] / 1000.0:
            self._stage = _Stage.LAND
            self._descent.start((home[0], home[1]))

    @property
    def landing(self) -> bool:
        """Whether it is coming down."""
        return self._stage is _Stage.LAND
