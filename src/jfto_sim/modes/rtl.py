"""RTL: up to RTL_ALT if lower, home in a straight line, wait, land or stay at RTL_ALT_FINAL."""

from __future__ import annotations

import math
from enum import Enum

from jfto_sim.flight import Flight
from jfto_sim.mission.fence import Fence
from jfto_sim.modes.mode import FlightMode, Mode, Mover
from jfto_sim.modes.simple import Land
from jfto_sim.motion.waypoint_nav import WaypointNav

_LEAST_HEIGHT_M = 2.0
_LEAST_CONE_SLOPE = 0.5
_HEADING_KEPT = (0, 2)  # WP_YAW_BEHAVIOR


class _Stage(Enum):
    CLIMB = 1
    RETURN = 2
    WAIT = 3
    DESCEND = 4
    LAND = 5


class Rtl(FlightMode):
    """Its heights are those of the parameters, but none above what `fence` keeps to."""

    number = Mode.RTL

    def __init__(self, flight: Flight, fence: Fence) -> None:
        super().__init__(flight)
        self._fence = fence
        self._nav = WaypointNav(flight.body, flight.limits.wpnav)
        self._land = Land(flight)
        self._mover = Mover(flight)
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
        """Above home: at least RTL_ALT, lower near home, below the ceiling, never a descent."""
        p = self.flight.params
        least = max(_LEAST_HEIGHT_M, height_m + max(0.0, p["RTL_CLIMB_MIN"] / 100.0))
        wanted = max(p["RTL_ALT"] / 100.0, least)
        if p["RTL_CONE_SLOPE"] >= _LEAST_CONE_SLOPE:
            wanted = min(wanted, max(distance_m * p["RTL_CONE_SLOPE"], least))
        return max(min(wanted, self._fence.ceiling_m), height_m)

    def step(self, dt_s: float) -> None:
        """Move the target and go on to the next stage when one is done."""
        if self._stage is _Stage.LAND:
            self._land.step(dt_s)
            return
        if self._stage is _Stage.DESCEND:
            self._descend(dt_s)
            return
        self._nav.step(dt_s)
        position = self.flight.position
        now, home = self.flight.clock.time_s, position.home_m
        if self._stage is _Stage.CLIMB and self._nav.reached:
            self._nav.set_destination((home[0], home[1], self._height_m))
            self._stage = _Stage.RETURN
        elif self._stage is _Stage.RETURN and self._nav.reached:
            self._waits_since_s = now
            self._stage = _Stage.WAIT
            if int(self.flight.params["WP_YAW_BEHAVIOR"]) not in _HEADING_KEPT:
                self.flight.heading.turn_to(position.home_heading_deg, 0.0, 0, relative=False)
        elif self._stage is _Stage.WAIT and self._waited(now):
            self._go_down()

    def _waited(self, now_s: float) -> bool:
        """Long enough, and turned as it stood when it was armed."""
        long_enough = now_s - self._waits_since_s >= self.flight.params["RTL_LOIT_TIME"] / 1000.0
        return long_enough and self.flight.heading.reached(self.flight.body.yaw_deg)

    def _go_down(self) -> None:
        home = self.flight.position.home_m
        if self.flight.params["RTL_ALT_FINAL"] > 0:
            self._mover.reset()
            self._stage = _Stage.DESCEND
        else:
            self._land.start((home[0], home[1]))
            self._stage = _Stage.LAND

    def _descend(self, dt_s: float) -> None:
        """To RTL_ALT_FINAL, and stay there."""
        flight, mover = self.flight, self._mover
        final_m = flight.position.home_m[2] + flight.params["RTL_ALT_FINAL"] / 100.0
        mover.brake(flight.limits.wpnav.accel_mps2, flight.limits.jerk_xy_mps3, dt_s)
        mover.climb_to(final_m, dt_s)
        mover.write()

    @property
    def landing(self) -> bool:
        """Whether it is coming down."""
        return self._stage is _Stage.LAND

    @property
    def goal(self) -> tuple[float, float]:
        """Distance in metres and bearing in degrees to the end of the leg."""
        return self._nav.distance_m, self._nav.bearing_deg
