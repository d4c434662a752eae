"""Where the vehicle is and where home is, on the globe and in metres of the power-up point."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from jfto_sim.clock import Clock
from jfto_sim.commands import Command, CommandHandler
from jfto_sim.config import VehicleConfig
from jfto_sim.dialect import ACCEPTED, FAILED, Message, mavlink
from jfto_sim.estimator import STOPPED_AIDING_AFTER_S, Estimator
from jfto_sim.geodesy import LOCATION_ALT_MAX_M, move, offset_m
from jfto_sim.motion.body import Body
from jfto_sim.ports import Ports

_NOISE_TIME_S = 3.0
# frames of targets and items
_MSL, _HOME, _TERRAIN = (0, 5), (3, 6), (10, 11)
_NAN = float("nan")


@dataclass
class Position:
    """`origin` is the power-up point in 1e-7 degree, `home_m` is home east, north, up of it."""

    config: VehicleConfig
    clock: Clock
    estimator: Estimator
    body: Body
    ports: Ports
    home_m: tuple[float, float, float] = (0.0, 0.0, 0.0)

    def __post_init__(self) -> None:
        self.origin = self.config.home_units
        self.home_heading_deg = self.body.yaw_deg
        self._noise_m = np.zeros(2)
        self._noise = np.random.default_rng(self.config.seed)
        self.commands: dict[int, CommandHandler] = {
            mavlink.MAV_CMD_DO_SET_HOME: self._do_set_home,
            mavlink.MAV_CMD_GET_HOME_POSITION: self._get_home,
        }

    @property
    def known(self) -> bool:
        """Whether there is a position at all, and a home."""
        return self.estimator.has_origin

    @property
    def from_home_known(self) -> bool:
        """Whether the estimator can tell how far home is: not long after the GPS has gone."""
        return self.known and self.estimator.lost_for_s < STOPPED_AIDING_AFTER_S

    def local_m(self, lat: int, lon: int) -> tuple[float, float]:
        """East and north of the power-up point of a place in 1e-7 degree."""
        return offset_m(*self.origin, lat, lon)

    def true(self) -> tuple[int, int]:
        """True latitude and longitude in 1e-7 degree."""
        x, y, _ = self.body.position_m
        return move(*self.origin, x, y)

    def reported(self) -> tuple[int, int, float]:
        """Latitude, longitude (1e-7 degree) and height above sea level as the vehicle believes."""
        if not self.known:
            return 0, 0, 0.0
        x, y, z = self.body.position_m
        lat, lon = move(*self.origin, x + self._noise_m[0], y + self._noise_m[1])
        return lat, lon, self.config.home_alt_m + z

    def stir_noise(self, dt_s: float) -> None:
        """Let the error of the reported position wander on."""
        sigma_m = self.config.gps_noise_m
        if sigma_m > 0:
            keep = math.exp(-dt_s / _NOISE_TIME_S)
            push = sigma_m * math.sqrt(1.0 - keep * keep)
            self._noise_m = keep * self._noise_m + push * self._noise.standard_normal(2)

    def home(self) -> tuple[int, int, float]:
        """Latitude, longitude (1e-7 degree) and height above sea level of home.

        All zero before there is a position.
        """
        if not self.known:
            return 0, 0, 0.0
        lat, lon = move(*self.origin, self.home_m[0], self.home_m[1])
        return lat, lon, self.config.home_alt_m + self.home_m[2]

    @property
    def from_home_m(self) -> tuple[float, float, float]:
        """East, north, up of home."""
        x, y, z = self.body.position_m
        return x - self.home_m[0], y - self.home_m[1], z - self.home_m[2]

    def height_of(self, alt_m: float, frame: int) -> float | None:
        """Height above the power-up point of an altitude in a frame; None if that is unknown.

        Unknown terrain counts as sea level.
        """
        if not abs(alt_m) < LOCATION_ALT_MAX_M:
            return None
        if frame in _HOME:
            return self.home_m[2] + alt_m
        if frame in _MSL or frame in _TERRAIN:
            return alt_m - self.config.home_alt_m
        return None

    # --- home ---

    def move_home(self) -> None:
        """Home is where the vehicle is now."""
        self.home_m = self.body.position_m
        self.home_heading_deg = self.body.yaw_deg
        self.announce_home()

    def set_home(self, lat: int, lon: int, alt_m: float) -> None:
        """Home is at a place the station or the mission names."""
        self.home_m = (*self.local_m(lat, lon), alt_m - self.config.home_alt_m)
        self.announce_home()

    def announce_home(self) -> None:
        """GPS_GLOBAL_ORIGIN and HOME_POSITION on every port."""
        self.ports.broadcast(self.origin_message(), everywhere=True)
        self.ports.broadcast(self.home_message(), everywhere=True)

    def origin_message(self) -> Message:
        """GPS_GLOBAL_ORIGIN."""
        alt = round(self.config.home_alt_m * 1000)
        return mavlink.MAVLink_gps_global_origin_message(*self.origin, alt, self.clock.time_us)

    def home_message(self) -> Message:
        """HOME_POSITION; x, y, z are metres north, east, down of the EKF origin."""
        lat, lon, alt_m = self.home()
        east, north, up = self.home_m
        return mavlink.MAVLink_home_position_message(
            lat, lon, round(alt_m * 1000), north, east, -up, [_NAN] * 4, 0.0, 0.0, 0.0,
            self.clock.time_us,
        )  # fmt: skip

    def _do_set_home(self, c: Command) -> int:
        if c.p[0] == 1:
            self.move_home()
        elif (c.x or c.y) and abs(c.z) < LOCATION_ALT_MAX_M:
            self.set_home(c.x, c.y, c.z)
        else:
            return FAILED
        return ACCEPTED

    def _get_home(self, c: Command) -> int:
        if not self.known:
            return FAILED
        self.ports.send(c.port, self.home_message())
        return ACCEPTED
