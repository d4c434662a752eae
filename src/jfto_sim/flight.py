"""What the vehicle knows about its own motion: body, home, heights, limits, touchdown."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from jfto_sim.dialect import INFO
from jfto_sim.geodesy import move, offset_m
from jfto_sim.mission.items import LOCATION_ALT_MAX_M
from jfto_sim.modes.numbers import Mode
from jfto_sim.motion.body import Body
from jfto_sim.motion.heading import Heading
from jfto_sim.telemetry import gps_global_origin, home_position
from jfto_world.motion.arducopter.wpnav import WpNav

if TYPE_CHECKING:
    from jfto_sim.arming import Arming
    from jfto_sim.battery import Battery
    from jfto_sim.config import VehicleConfig
    from jfto_sim.dialect import Message
    from jfto_sim.estimator import Estimator
    from jfto_sim.modes.auto import Auto
    from jfto_sim.modes.base import FlightMode
    from jfto_sim.modes.guided import Guided
    from jfto_sim.params import Parameters

_LEAST_SPEED_CMS = 20.0
_LAND_COMPLETE_AFTER_S, _DISARM_AFTER_S = 1.1, 2.1
_YAW_ALIGNED_ABOVE_M = 1.9
_NOISE_TIME_S = 3.0
# frames of targets and items
_MSL, _HOME, _TERRAIN = (0, 5), (3, 6), (10, 11)


class Flight:
    """Mixin of `Vehicle`: everything between the flight mode and the body."""

    config: VehicleConfig
    params: Parameters
    estimator: Estimator
    battery: Battery
    arming: Arming
    mode: FlightMode
    auto: Auto
    guided: Guided
    origin: tuple[int, int]
    time_s: float

    if TYPE_CHECKING:

        def text(self, severity: int, text: str, port: int | None = None) -> None:
            """Of `Vehicle`."""

        def broadcast(self, message: Message, *, everywhere: bool = False) -> None:
            """Of `Vehicle`."""

    def reset_motion(self) -> None:
        """As after power-up: on the ground where it stands, heading as it was set down."""
        before = getattr(self, "body", None)
        heading = self.config.heading_deg if before is None else before.yaw_deg
        self.body = Body(self.config.airframe, heading, self.config.ground)
        if before is not None:
            self.body.state[:3] = before.state[:3]
        self.heading = Heading(heading)
        self.home_m = (0.0, 0.0, 0.0)
        self.armed_heading_deg = heading
        self.land_complete = True
        self.down_since_s: float | None = None
        self.airborne_s = 0.0
        self.flight_time_s = 0.0
        self._told_flight_s = 0
        self.motor_failed_for_s = 0.0
        self.speed_override_mps: float | None = None
        self.climb_override_mps: float | None = None
        self.sink_override_mps: float | None = None
        self._yaw_aligned = False
        self._wpnav: WpNav | None = None
        self._noise_m = np.zeros(2)
        self._noise = np.random.default_rng(self.config.seed)

    # --- limits ---

    @property
    def wpnav(self) -> WpNav:
        """The planner's parameters as they stand."""
        if self._wpnav is None:
            self._wpnav = self.wpnav_at(0.0)
        return self._wpnav

    def wpnav_at(self, speed_cms: float) -> WpNav:
        """The same with another horizontal speed; 0 means WPNAV_SPEED."""
        p = self.params
        if speed_cms <= 0 and self.speed_override_mps is not None:
            speed_cms = 100.0 * self.speed_override_mps
        speed = max(speed_cms if speed_cms > 0 else p["WPNAV_SPEED"], _LEAST_SPEED_CMS)
        up = self.climb_override_mps or max(p["WPNAV_SPEED_UP"], 10.0) / 100.0
        down = self.sink_override_mps or max(p["WPNAV_SPEED_DN"], 10.0) / 100.0
        return WpNav(
            speed_mps=speed / 100.0,
            speed_up_mps=up,
            speed_dn_mps=down,
            accel_mps2=max(p["WPNAV_ACCEL"], 50.0) / 100.0,
            accel_z_mps2=max(p["WPNAV_ACCEL_Z"], 50.0) / 100.0,
            corner_accel_mps2=max(p["WPNAV_ACCEL_C"], 0.0) / 100.0,
            jerk_mps3=max(p["WPNAV_JERK"], 0.1),
            radius_m=max(p["WPNAV_RADIUS"], 5.0) / 100.0,
            input_tc_s=max(p["ATC_INPUT_TC"], 0.01),
            angle_max_deg=min(max(p["ANGLE_MAX"], 1000.0), 8000.0) / 100.0,
        )

    def forget_limits(self) -> None:
        """A parameter has changed."""
        self._wpnav = None
        self.body.configure(self.wpnav)

    @property
    def jerk_xy_mps3(self) -> float:
        """PSC_JERK_XY."""
        return max(self.params["PSC_JERK_XY"], 0.5)

    @property
    def jerk_z_mps3(self) -> float:
        """PSC_JERK_Z."""
        return max(self.params["PSC_JERK_Z"], 0.5)

    @property
    def wind_mps(self) -> tuple[float, float]:
        """Where the air moves to (east, north): the configuration's wind plus SIM_WIND_*."""
        speed = self.params["SIM_WIND_SPD"]
        coming = math.radians(self.params["SIM_WIND_DIR"])
        east, north = self.config.wind_mps
        return east - speed * math.sin(coming), north - speed * math.cos(coming)

    # --- places ---

    def local_m(self, lat: int, lon: int) -> tuple[float, float, float]:
        """East and north of the power-up point, and 0."""
        east, north = offset_m(*self.origin, lat, lon)
        return east, north, 0.0

    def place(self) -> tuple[int, int]:
        """True latitude and longitude in 1e-7 degree."""
        x, y, _ = self.body.position_m
        return move(*self.origin, x, y)

    def reported_position(self) -> tuple[int, int, float]:
        """Latitude, longitude (1e-7 degree) and height above sea level as the vehicle believes."""
        x, y, z = self.body.position_m
        if not self.estimator.has_origin(self.time_s):
            return 0, 0, 0.0
        lat, lon = move(*self.origin, x + self._noise_m[0], y + self._noise_m[1])
        return lat, lon, self.config.home_alt_m + z

    def home_item(self) -> tuple[int, int, float]:
        """Home as mission item 0: all zero before there is a position."""
        if not self.estimator.has_origin(self.time_s):
            return 0, 0, 0.0
        lat, lon = move(*self.origin, self.home_m[0], self.home_m[1])
        return lat, lon, self.config.home_alt_m + self.home_m[2]

    @property
    def position_from_home_m(self) -> tuple[float, float, float]:
        """East, north, up of home."""
        x, y, z = self.body.position_m
        return x - self.home_m[0], y - self.home_m[1], z - self.home_m[2]

    @property
    def height_above_home_m(self) -> float:
        """Height above home."""
        return self.body.position_m[2] - self.home_m[2]

    def height_of(self, alt_m: float, frame: int) -> float | None:
        """Height above the power-up point of an altitude in a frame; None if that is unknown."""
        if not abs(alt_m) < LOCATION_ALT_MAX_M:
            return None
        if frame in _HOME:
            return self.home_m[2] + alt_m
        if frame in _MSL or frame in _TERRAIN:
            return alt_m - self.config.home_alt_m
        return None

    @property
    def position_ok(self) -> bool:
        """Whether modes that need a position may be entered."""
        return self.estimator.position_ok(self.time_s)

    def goal(self) -> tuple[float, float]:
        """Distance in metres and bearing in degrees to what is being flown to."""
        if self.mode.number == Mode.AUTO:
            nav = self.auto.nav
        elif self.mode.number == Mode.RTL:
            nav = self.mode.home.nav  # type: ignore[attr-defined]
        else:
            return self.guided.distance_m if self.mode.number == Mode.GUIDED else 0.0, 0.0
        return nav.distance_m, nav.bearing_deg

    # --- home ---

    def announce_home(self, *, everywhere: bool = False) -> None:
        """GPS_GLOBAL_ORIGIN and HOME_POSITION."""
        self.broadcast(gps_global_origin(self), everywhere=everywhere)  # type: ignore[arg-type]
        self.broadcast(home_position(self), everywhere=everywhere)  # type: ignore[arg-type]

    def move_home(self) -> None:
        """Home is where the vehicle is now."""
        self.home_m = self.body.position_m
        self.armed_heading_deg = self.body.yaw_deg
        self.announce_home(everywhere=True)

    def set_home(self, lat: int, lon: int, alt_m: float) -> None:
        """Home is at a place the station or the mission names."""
        east, north, _ = self.local_m(lat, lon)
        self.home_m = (east, north, alt_m - self.config.home_alt_m)
        self.announce_home(everywhere=True)

    # --- one step ---

    def step_motion(self, dt_s: float) -> None:
        """Mode, heading, body, ground."""
        body, armed = self.body, self.arming.armed
        was_down = body.landed
        self.battery.draw(armed=armed, flying=not was_down, dt_s=dt_s)
        self._stir_noise(dt_s)
        if armed and not was_down:
            self._fly(0.5 * dt_s)
        self.mode.step(dt_s)
        if armed and self.arming.armed and not was_down and not body.landed:
            self._fly(0.5 * dt_s)
        if not self.arming.armed:
            return
        if body.failed:
            self.motor_failed_for_s += dt_s
        if body.landed:
            self._on_ground()
        elif was_down:
            self.land_complete, self.down_since_s = False, None
            self._yaw_aligned = False

    def _fly(self, dt_s: float) -> None:
        """Heading and body follow the target of the step before, as the autopilot's loops do."""
        body, target = self.body, self.body.target
        wanted, rate = self.heading.step(
            (float(target[0, 0]), float(target[0, 1])),
            (float(target[1, 0]), float(target[1, 1])),
            dt_s,
        )
        body.turn(wanted, rate, dt_s)
        body.fly(self.wind_mps, dt_s)
        self.airborne_s = self.time_s
        self.flight_time_s += dt_s
        if not self._yaw_aligned and body.position_m[2] > _YAW_ALIGNED_ABOVE_M:
            self._yaw_aligned = True
            for imu in (0, 1):
                self.text(INFO, f"EKF3 IMU{imu} MAG0 in-flight yaw alignment complete")
        if body.landed:
            self.down_since_s = self.time_s
            self.text(INFO, f"SIM Hit ground at {body.hit_ground_mps:f} m/s")

    def _on_ground(self) -> None:
        if self.down_since_s is not None and not self.body.failed:
            down_s = self.time_s - self.down_since_s
            if down_s >= _LAND_COMPLETE_AFTER_S:
                self.land_complete = True
            if down_s >= _DISARM_AFTER_S and self.mode.landing:
                self.arming.release()
                return
        if not self.land_complete or self.mode.taking_off:
            return
        idle_since = max(self.arming.armed_at_s, self.airborne_s)
        delay_s = self.params["DISARM_DELAY"]
        if delay_s > 0 and self.time_s - idle_since >= delay_s:
            self.arming.release()

    @property
    def down_and_still(self) -> bool:
        """Whether a landing is over."""
        return self.body.landed and self.land_complete

    def _stir_noise(self, dt_s: float) -> None:
        sigma = self.config.gps_noise_m
        if sigma > 0:
            keep = math.exp(-dt_s / _NOISE_TIME_S)
            push = sigma * math.sqrt(1.0 - keep * keep)
            self._noise_m = keep * self._noise_m + push * self._noise.standard_normal(2)

    def note_flight_time(self, flown_s: float) -> bool:
        """Store whole seconds of flight; true if they changed since last told."""
        whole = int(flown_s)
        if whole == self._told_flight_s:
            return False
        gained, self._told_flight_s = whole - self._told_flight_s, whole
        self.params.store("STAT_FLTTIME", self.params["STAT_FLTTIME"] + gained)
        return True
