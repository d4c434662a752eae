"""Modes without a plan of their own: manual ones with the sticks at rest, LOITER, BRAKE, LAND, RTL.

The throttle stick is down, as in the recordings, and so the modes that follow it sink.
"""

from __future__ import annotations

import math
from enum import Enum

from jfto_sim.flight import Flight
from jfto_sim.modes.mode import FlightMode, Mode, Mover
from jfto_sim.motion.shaping import sqrt_controller
from jfto_sim.motion.waypoint_nav import WaypointNav
from jfto_world.motion.arducopter.wpnav import WpNav

_BRAKE_MPS2, _BRAKE_JERK_MPS3 = 7.5, 40.0
_STICK_LOW_MPS = -2.5
_COAST_MPS2 = 0.7
_FAILSAFE_PAUSE_S = 4.0
_LAND_GAIN = 1.0
_CONE_CLIMB_MIN_M = 2.0
_HEADING_KEPT = (0, 2)  # WP_YAW_BEHAVIOR


class _Stopping(FlightMode):
    """Comes to rest horizontally."""

    def __init__(self, flight: Flight) -> None:
        super().__init__(flight)
        self._mover = Mover(flight)

    def enter(self) -> bool:
        """From the vehicle's own motion."""
        self._mover.reset()
        return True

    def _stop(self, accel_mps2: float, jerk_mps3: float, climb_mps: float, dt_s: float) -> None:
        self._mover.brake(accel_mps2, jerk_mps3, dt_s)
        self._mover.climb(climb_mps, dt_s)
        self._mover.write()


class Manual(_Stopping):
    """STABILIZE and ALT_HOLD: level, sinking."""

    def __init__(self, flight: Flight, number: Mode) -> None:
        super().__init__(flight)
        self.number = number

    def step(self, dt_s: float) -> None:
        """Level, sinking."""
        limits = self.flight.limits
        self._stop(limits.wpnav.accel_mps2, limits.jerk_xy_mps3, _STICK_LOW_MPS, dt_s)


class Brake(_Stopping):
    """BRAKE: come to rest as fast as possible and stay."""

    number = Mode.BRAKE

    def enter(self) -> bool:
        """Keep the heading too."""
        self.flight.heading.hold()
        return super().enter()

    def step(self, dt_s: float) -> None:
        """Brake, hold the height."""
        self._stop(_BRAKE_MPS2, _BRAKE_JERK_MPS3, 0.0, dt_s)


class Loiter(_Stopping):
    """LOITER: coasts for LOIT_BRK_DELAY, brakes and stays over the place, sinking."""

    number = Mode.LOITER

    def enter(self) -> bool:
        """Keep the heading too."""
        self._brakes_at_s = self.flight.clock.time_s + self.flight.params["LOIT_BRK_DELAY"]
        self.flight.heading.hold()
        return super().enter()

    def step(self, dt_s: float) -> None:
        """Coast or brake, sink."""
        braking = self.flight.clock.time_s >= self._brakes_at_s
        accel = self.flight.params["LOIT_BRK_ACCEL"] / 100.0 if braking else _COAST_MPS2
        self._stop(max(accel, 0.1), self.flight.limits.jerk_xy_mps3, _STICK_LOW_MPS, dt_s)


class Land(FlightMode):
    """LAND: vertical at the speeds of LAND_*; touchdown is the body's business."""

    number = Mode.LAND

    def __init__(self, flight: Flight) -> None:
        super().__init__(flight)
        self._mover = Mover(flight)
        self._place_m: tuple[float, float] | None = None
        self._sinks_from_s = 0.0

    def enter(self) -> bool:
        """Where the vehicle can stop."""
        self.start(None)
        return True

    def start(self, place_m: tuple[float, float] | None) -> None:
        """Land at a place, east and north of the power-up point, or where the vehicle can stop."""
        self._mover.reset()
        self._place_m = place_m
        self._sinks_from_s = 0.0
        self.flight.heading.hold()

    def wait(self) -> None:
        """A failsafe waits a few seconds before it comes down."""
        self._sinks_from_s = self.flight.clock.time_s + _FAILSAFE_PAUSE_S

    def step(self, dt_s: float) -> None:
        """Sink: fast above LAND_ALT_LOW, then at LAND_SPEED."""
        limits, mover = self.flight.limits, self._mover
        p, jerk = limits.wpnav, limits.jerk_xy_mps3
        waiting = self.flight.clock.time_s < self._sinks_from_s
        mover.climb(0.0 if waiting else self._rate_mps(p, dt_s), dt_s)
        if self._place_m is None:
            mover.brake(p.accel_mps2, jerk, dt_s)
        else:
            still = ((0.0, 0.0), (0.0, 0.0))
            speeds = (p.speed_mps, p.accel_mps2, jerk)
            mover.level.towards_position(self._place_m, still, speeds, dt_s)
        mover.write()

    def _rate_mps(self, p: WpNav, dt_s: float) -> float:
        params = self.flight.params
        fast = params["LAND_SPEED_HIGH"] / 100.0 or p.speed_dn_mps
        slow = params["LAND_SPEED"] / 100.0
        above = params["LAND_ALT_LOW"] / 100.0 - self.flight.position.from_home_m[2]
        rate = sqrt_controller(above, _LAND_GAIN, p.accel_z_mps2, dt_s)
        return max(-max(fast, slow), min(-slow, rate))

    @property
    def landing(self) -> bool:
        """Always."""
        return True


class _Stage(Enum):
    CLIMB = 1
    RETURN = 2
    WAIT = 3
    LAND = 4


class Rtl(FlightMode):
    """RTL: up to RTL_ALT if lower, home in a straight line, wait, land."""

    number = Mode.RTL

    def __init__(self, flight: Flight) -> None:
        super().__init__(flight)
        self._nav = WaypointNav(flight.body, flight.limits.wpnav)
        self._land = Land(flight)
        self._stage = _Stage.CLIMB
        self._height_m = 0.0
        self._waits_since_s = 0.0

    def enter(self) -> bool:
        """From the point where the vehicle can stop."""
        flight, nav = self.flight, self._nav
        nav.start(flight.limits.at(flight.params["RTL_SPEED"]))
        x, y, z = nav.destination
        home = flight.position.home_m
        self._height_m = self._return_height(math.dist((x, y), home[:2]), z - home[2]) + home[2]
        nav.set_destination((x, y, self._height_m))
        nav.set_next((home[0], home[1], self._height_m))
        self._stage = _Stage.CLIMB
        flight.heading.hold()
        return True

    def _return_height(self, distance_m: float, height_m: float) -> float:
        p = self.flight.params
        wanted = max(height_m + p["RTL_CLIMB_MIN"] / 100.0, p["RTL_ALT"] / 100.0, height_m)
        slope = p["RTL_CONE_SLOPE"]
        if slope > 0:
            cone = max(distance_m * slope, _CONE_CLIMB_MIN_M)
            wanted = max(height_m, min(wanted, cone))
        return wanted

    def step(self, dt_s: float) -> None:
        """Move the target and go on to the next stage when one is done."""
        if self._stage is _Stage.LAND:
            self._land.step(dt_s)
            return
        self._nav.step(dt_s)
        params, position = self.flight.params, self.flight.position
        now, home = self.flight.clock.time_s, position.home_m
        waited_s = now - self._waits_since_s
        if self._stage is _Stage.CLIMB and self._nav.reached:
            self._nav.set_destination((home[0], home[1], self._height_m))
            self._stage = _Stage.RETURN
        elif self._stage is _Stage.RETURN and self._nav.reached:
            self._waits_since_s = now
            self._stage = _Stage.WAIT
            if int(params["WP_YAW_BEHAVIOR"]) not in _HEADING_KEPT:
                self.flight.heading.turn_to(position.home_heading_deg, 0.0, 0, relative=False)
        elif self._stage is _Stage.WAIT and waited_s >= params["RTL_LOIT_TIME"] / 1000.0:
            self._stage = _Stage.LAND
            self._land.start((home[0], home[1]))

    @property
    def landing(self) -> bool:
        """Whether it is coming down."""
        return self._stage is _Stage.LAND

    @property
    def goal(self) -> tuple[float, float]:
        """Distance in metres and bearing in degrees to the end of the leg."""
        return self._nav.distance_m, self._nav.bearing_deg
