"""The camera: one CAMERA_FEEDBACK per picture, sent unasked."""

from __future__ import annotations

import math
from dataclasses import dataclass

from jfto_sim.commands import Command, CommandHandler
from jfto_sim.dialect import ACCEPTED, FAILED, UNSUPPORTED, mavlink
from jfto_sim.flight import Flight


@dataclass
class Camera:
    """Exists only if CAM1_TYPE was set when the vehicle powered up; its mount shows nothing."""

    flight: Flight
    _count: int = 0
    _spacing_m: float = 0.0
    _last_m: tuple[float, float, float] | None = None
    _interval_s: float = 0.0
    _left: int = 0
    _last_s: float = -math.inf

    def __post_init__(self) -> None:
        self._present = self.flight.params["CAM1_TYPE"] != 0
        self.commands: dict[int, CommandHandler] = {
            mavlink.MAV_CMD_DO_DIGICAM_CONTROL: self._do_shoot,
            mavlink.MAV_CMD_IMAGE_START_CAPTURE: self._do_shoot,
            mavlink.MAV_CMD_DO_SET_CAM_TRIGG_DIST: self._do_every,
            mavlink.MAV_CMD_DO_MOUNT_CONTROL: self._do_mount,
        }

    def every(self, spacing_m: float, *, at_once: bool) -> None:
        """A picture per distance flown; 0 stops."""
        self._spacing_m = max(0.0, spacing_m)
        self._last_m = self.flight.body.position_m
        if at_once and spacing_m > 0:
            self.shoot()

    def series(self, interval_s: float, count: int) -> None:
        """So many pictures (-1: without end) with more than an interval between any two."""
        self._interval_s, self._left = interval_s, count

    def step(self) -> None:
        """Trigger by time or, without that, by distance."""
        if self._left:
            if self.flight.clock.time_s - self._last_s > self._interval_s:
                self._left -= self._left > 0
                self.shoot()
            return
        if self._spacing_m <= 0 or self._last_m is None:
            return
        here = self.flight.body.position_m
        if math.dist(here[:2], self._last_m[:2]) >= self._spacing_m:
            self.shoot()

    def shoot(self) -> None:
        """Take a picture, if there is a camera."""
        if not self._present:
            return
        self._count += 1
        body, position = self.flight.body, self.flight.position
        self._last_m, self._last_s = body.position_m, self.flight.clock.time_s
        lat, lon, alt_m = position.reported()
        roll, pitch = body.attitude_deg
        self.flight.ports.broadcast(
            mavlink.MAVLink_camera_feedback_message(
                self.flight.clock.utc_us, 0, 0, self._count, lat, lon, alt_m,
                position.from_home_m[2], roll, pitch, body.yaw_deg, 0.0, 0, 0,
            )
        )  # fmt: skip

    def _do_shoot(self, _c: Command) -> int:
        self.shoot()
        return ACCEPTED if self._present else UNSUPPORTED

    def _do_every(self, c: Command) -> int:
        if not self._present:
            return UNSUPPORTED
        self.every(c.p[0], at_once=c.p[2] == 1)
        return ACCEPTED

    def _do_mount(self, _c: Command) -> int:
        return ACCEPTED if self.flight.params["MNT1_TYPE"] else FAILED
