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
        "Width and height of the ground in one image at coverage.distance_m, instead of "
        "camera.sensor_mm and camera.focal_length_mm.",
        unit="m",
        low=0.1,
        high=5000.0,
        length=2,
    )
    exposure_s: float = param(
        0.001, "Exposure time, for trajectory.photo_blur_px.", unit="s", low=1e-6, high=60.0
    )


@dataclass(frozen=True)
class CoveragePart:
    """How the surface is to be photographed."""

    distance_m: float = param(
        0.0,
        "Distance from the surface along its normal; 0: the distance that gives coverage.gsd_cm.",
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
    clearance_radius_m: float = param(
        30.0,
        "Radius around a waypoint within which coverage.height_min_m holds.",
        unit="m",
        low=0.0,
        high=1000.0,
    )
    pitch_min_deg: float = param(
        -90.0, "Lowest gimbal pitch; -90 is straight down.", unit="deg", low=-90.0, high=90.0
    )
    pitch_max_deg: float = param(
        20.0, "Highest gimbal pitch; 0 is the horizon.", unit="deg", low=-90.0, high=90.0
    )
    fill_gaps: bool = param(True, "Add waypoints where the regular grid leaves ground unseen.")
