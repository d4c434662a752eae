"""The camera and how it must see the ground."""

from __future__ import annotations

from dataclasses import dataclass

from jfto_msgs_py.scenario.key import param


@dataclass(frozen=True)
class CameraPart:
    """The camera that every UAV carries."""

    sensor_mm: tuple[float, ...] = param(
        (13.2, 8.8), "Width and height of the sensor.", unit="mm", low=0.5, high=100.0, length=2
    )
    focal_length_mm: float = param(8.8, "Focal length.", unit="mm", low=0.5, high=1000.0)
    image_px: tuple[int, ...] = param(
        (5472, 3648), "Width and height of an image.", unit="px", low=16, high=100_000, length=2
    )
    footprint_m: tuple[float, ...] = param(
        (),
        "Width and height of the ground that one image must cover. Overrides coverage.distance_m "
        "and coverage.gsd_cm.",
        unit="m",
        low=0.1,
        high=5000.0,
        length=2,
    )


@dataclass(frozen=True)
class CoveragePart:
    """How the surface is to be photographed."""

    distance_m: float = param(
        0.0,
        "Distance from the surface along its normal. 0: from coverage.gsd_cm.",
        unit="m",
        low=0.0,
        high=2000.0,
    )
    gsd_cm: float = param(
        4.0,
        "Ground sampling distance, size of a pixel on the surface.",
        unit="cm/px",
        low=0.01,
        high=200.0,
    )
    overlap_h: float = param(
        0.3, "Overlap of neighbouring images across, σ_h.", low=0.0, high=1.0, strict=True
    )
    overlap_v: float = param(
        0.3, "Overlap of neighbouring images along, σ_v.", low=0.0, high=1.0, strict=True
    )
    height_min_m: float = param(
        20.0, "Least height above ground of any waypoint.", unit="m", low=0.0, high=2000.0
    )
    tilt_max_deg: float = param(
        60.0,
        "Greatest tilt of the gimbal away from straight down.",
        unit="deg",
        low=0.0,
        high=90.0,
    )
