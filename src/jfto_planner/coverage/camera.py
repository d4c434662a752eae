"""The camera under a UAV: a pinhole with a rectangular sensor."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields

import numpy as np

from jfto_msgs_py.errors import InputError
from jfto_msgs_py.records.plan import Waypoint
from jfto_msgs_py.types import Array

_FULL_FRAME_MM = 36.0


@dataclass(frozen=True)
class Camera:
    """Sensor and lens. The image's long side is level, as a gimbal without roll holds it."""

    sensor_width_mm: float
    sensor_height_mm: float
    focal_length_mm: float
    image_width_px: int
    image_height_px: int

    def __post_init__(self) -> None:
        for field in fields(self):
            value = getattr(self, field.name)
            if not (math.isfinite(value) and value > 0):
                raise InputError(f"camera.{field.name} is {value}, must be positive.")

    @classmethod
    def from_footprint(
        cls,
        width_m: float,
        height_m: float,
        distance_m: float,
        image_width_px: int,
        image_height_px: int,
    ) -> Camera:
        """Camera that sees width × height metres (the paper's L × W) at the given distance."""
        for name, value in (
            ("width_m", width_m),
            ("height_m", height_m),
            ("distance_m", distance_m),
        ):
            if not (math.isfinite(value) and value > 0):
                raise InputError(f"camera footprint {name} is {value}, must be positive.")
        return cls(
            sensor_width_mm=_FULL_FRAME_MM,
            sensor_height_mm=_FULL_FRAME_MM * height_m / width_m,
            focal_length_mm=_FULL_FRAME_MM * distance_m / width_m,
            image_width_px=image_width_px,
            image_height_px=image_height_px,
        )

    @property
    def half_width(self) -> float:
        """Tangent of half the horizontal field of view."""
        return self.sensor_width_mm / (2 * self.focal_length_mm)

    @property
    def half_height(self) -> float:
        """Tangent of half the vertical field of view."""
        return self.sensor_height_mm / (2 * self.focal_length_mm)

    def footprint_m(self, distance_m: float) -> tuple[float, float]:
        """Width and height in metres of what is seen of a plane facing the camera."""
        return 2 * self.half_width * distance_m, 2 * self.half_height * distance_m

    @property
    def gsd_per_metre(self) -> float:
        """Ground resolution in metres per pixel at 1 m distance, of the coarser image side."""
        return max(
            2 * self.half_width / self.image_width_px, 2 * self.half_height / self.image_height_px
        )

    def gsd_m(self, distance_m: float) -> float:
        """Ground resolution in metres per pixel on a plane facing the camera."""
        return self.gsd_per_metre * distance_m

    def distance_for_gsd(self, gsd_m: float) -> float:
        """Distance in metres at which the ground resolution is `gsd_m` metres per pixel."""
        return gsd_m / self.gsd_per_metre


def view_axes(waypoint: Waypoint) -> tuple[Array, Array, Array]:
    """Unit vectors (3,) of a photo in ENU: along its axis, to its right, to its upper edge."""
    yaw, pitch = math.radians(waypoint.yaw_deg), math.radians(waypoint.pitch_deg)
    look = np.array(
        [math.sin(yaw) * math.cos(pitch), math.cos(yaw) * math.cos(pitch), math.sin(pitch)]
    )
    right = np.array([math.cos(yaw), -math.sin(yaw), 0.0])
    return look, right, np.cross(right, look)
