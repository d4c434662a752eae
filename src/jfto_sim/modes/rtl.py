"""RTL: up to RTL_ALT if lower, home in a straight line, wait, land."""

from __future__ import annotations

import math
from enum import Enum
from typing import TYPE_CHECKING

from jfto_sim.modes.base import Descent, FlightMode
from jfto_sim.modes.numbers import Mode
from jfto_sim.motion.waypoint_nav import WaypointNav

if TYPE_CHECKING:
    from jfto_sim.vehicle import Vehicle

_CONE_CLIMB_MIN_M = 2.0
_HEADING_KEPT = (0, 2)  # WP_YAW_BEHAVIOR


class _Stage(Enum):
    CLIMB = 1
    RETURN = 2
    WAIT = 3
    LAND = 4


class ReturnHome:
    """The manoeuvre itself, used by RTL mode and by an RTL item in AUTO."""

    def __init__(self, vehicle: Vehicle) -> None:
        self.vehicle = vehicle
        self.nav = WaypointNav(vehicle.body, vehicle.wpnav)
        self.descent = Descent(vehicle)
        self.stage = _Stage.CLIMB
        self._waits_since_s = 0.0

    def start(self) -> None:
        """From the point where the vehicle can stop."""
        v = self.vehicle
        self.nav.start(v.wpnav_at(v.params["RTL_SPEED"]))
        x, y, z = self.nav.destination
        home = v.home_m
        self.height_m = self._return_height(math.dist((x, y), home[:2]), z - home[2]) + home[2]
        self.nav.set_destination((x, y, self.height_m))
        self.nav.set_next((home[0], home[1], self.height_m))
        self.stage = _Stage.CLIMB
        v.heading.hold(v.heading.demand_deg)

    def _return_height(self, distance_m: float, height_m: float) -> float:
        p = self.vehicle.params
        wanted = max(height_m + p["RTL_CLIMB_MIN"] / 100.0, p["RTL_ALT"] / 100.0, height_m)
        slope = p["RTL_CONE_SLOPE"]
        if slope > 0:
            cone = max(distance_m * slope, _CONE_CLIMB_MIN_M)
            wanted = max(height_m, min(wanted, cone))
        return wanted

    def step(self, dt_s: float) -> None:
        """Move the target and go on to the next stage when one is done."""
        v = self.vehicle
        if self.stage is _Stage.LAND:
            self.descent.step(dt_s)
            return
        self.nav.step(dt_s)
        home = v.home_m
        if self.stage is _Stage.CLIMB and self.nav.reached:
            self.nav.set_destination((home[0], home[1], self.height_m))
            self.stage = _Stage.RETURN
        elif self.stage is _Stage.RETURN and self.nav.reached:
            self._waits_since_s = v.time_s
            self.stage = _Stage.WAIT
            if int(v.params["WP_YAW_BEHAVIOR"]) not in _HEADING_KEPT:
                v.heading.turn_to(v.armed_heading_deg, 0.0, 0, relative=False)
        elif self.stage is _Stage.WAIT and self._waited_s() >= v.params["RTL_LOIT_TIME"] / 1000.0:
            self.stage = _Stage.LAND
            self.descent.start((home[0], home[1]))

    def _waited_s(self) -> float:
        return self.vehicle.time_s - self._waits_since_s

    @property
    def landing(self) -> bool:
        """Whether it is coming down."""
        return self.stage is _Stage.LAND


class Rtl(FlightMode):
    """RTL as a mode."""

    number = Mode.RTL

    def __init__(self, vehicle: Vehicle) -> None:
        super().__init__(vehicle)
        self.home = ReturnHome(vehicle)

    def enter(self) -> bool:
        """Needs a position once armed."""
        if self.vehicle.arming.armed and not self.vehicle.position_ok:
            return False
        self.home.start()
        return True

    def step(self, dt_s: float) -> None:
        """Go home."""
        self.home.step(dt_s)

    @property
    def landing(self) -> bool:
        """Whether it is coming down."""
        return self.home.landing
