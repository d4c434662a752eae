"""The camera: one CAMERA_FEEDBACK per picture, sent unasked."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from jfto_sim.dialect import mavlink

if TYPE_CHECKING:
    from jfto_sim.vehicle import Vehicle


class Camera:
    """Exists only if CAM1_TYPE was set when the vehicle powered up."""

    def __init__(self, vehicle: Vehicle) -> None:
        self.vehicle = vehicle
        self.present = vehicle.params["CAM1_TYPE"] != 0
        self.count = 0
        self.mount_pitch_deg = 0.0
        self._spacing_m = 0.0
        self._last_m: tuple[float, float, float] | None = None

    def every(self, spacing_m: float, *, at_once: bool) -> None:
        """A picture per distance flown; 0 stops."""
        self._spacing_m = max(0.0, spacing_m)
        self._last_m = self.vehicle.body.position_m
        if at_once and spacing_m > 0:
            self.shoot()

    def step(self) -> None:
        """Trigger by distance."""
        if self._spacing_m <= 0 or self._last_m is None:
            return
        here = self.vehicle.body.position_m
        if math.dist(here[:2], self._last_m[:2]) >= self._spacing_m:
            self._last_m = here
            self.shoot()

    def shoot(self) -> None:
        """Take a picture, if there is a camera."""
        if not self.present:
            return
        v = self.vehicle
        self.count += 1
        lat, lon, alt_m = v.reported_position()
        roll, pitch = v.body.attitude_deg
        v.broadcast(
            mavlink.MAVLink_camera_feedback_message(
                v.utc_us, 0, 0, self.count, lat, lon, alt_m, v.height_above_home_m,
                roll, pitch, v.body.yaw_deg, 0.0, 0, 0,
            )
        )  # fmt: skip
