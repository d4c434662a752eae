"""What a user asks of the coverage."""

from __future__ import annotations

import math
from dataclasses import dataclass

from jfto_msgs_py.errors import InputError
from jfto_planner.coverage.camera import Camera


@dataclass(frozen=True)
class CoverageSettings:
    """Overlaps σ_h, σ_v and either the distance to the surface or the ground resolution.

    `min_height_m` holds above all ground within `clearance_radius_m` of a waypoint. Gimbal pitch
    is 0 at the horizon and -90 straight down. Normals are those of the surface smoothed over
    `smoothing_m` (a Gaussian's standard deviation; None: 0.3 of the footprint's mean side). Where
    it is flatter than `level_below_deg` the camera looks straight down, with a fixed yaw, so
    that level ground is photographed in parallel. With `fill_gaps`, photos are added where the
    regular grid leaves ground unseen, until `min_seen_once` of the area is seen. Rows of the grid
    head `heading_deg` clockwise from north (None: the best); `crosshatch` lays a second one across.
    """

    overlap_h: float = 0.3
    overlap_v: float = 0.3
    distance_m: float | None = None
    gsd_m: float | None = None
    min_height_m: float = 30.0
    clearance_radius_m: float = 30.0
    gimbal_pitch_min_deg: float = -90.0
    gimbal_pitch_max_deg: float = 20.0
    smoothing_m: float | None = None
    level_below_deg: float = 3.0
    fill_gaps: bool = True
    min_seen_once: float = 0.99
    max_waypoints: int = 5000
    heading_deg: float | None = None
    crosshatch: bool = False

    def __post_init__(self) -> None:
        for name in ("overlap_h", "overlap_v"):
            if not 0 < getattr(self, name) < 1:
                raise InputError(
                    f"coverage.{name} is {getattr(self, name)}, must be between 0 and 1."
                )
        if (self.distance_m is None) == (self.gsd_m is None):
            raise InputError("coverage needs either distance_m or gsd_m, and not both.")
        for name in ("distance_m", "gsd_m", "smoothing_m", "max_waypoints"):
            self._check_positive(name)
        for name in ("min_height_m", "clearance_radius_m", "level_below_deg"):
            value = getattr(self, name)
            if not (math.isfinite(value) and value >= 0):
                raise InputError(f"{name} is {value}, must be 0 or more.")
        if not 0 <= self.min_seen_once <= 1:
            raise InputError(f"min_seen_once is {self.min_seen_once}, must be a share from 0 to 1.")
        if self.heading_deg is not None and not math.isfinite(self.heading_deg):
            raise InputError(f"heading_deg is {self.heading_deg}, must be finite.")
        low, high = self.gimbal_pitch_min_deg, self.gimbal_pitch_max_deg
        if not -90 <= low <= high <= 90:
            raise InputError(
                f"gimbal_pitch_min_deg, _max_deg are {low}, {high}: must rise and lie "
                "within -90 (down) to 90 (up)."
            )

    @property
    def overlaps(self) -> tuple[float, float]:
        """σ_h and σ_v."""
        return self.overlap_h, self.overlap_v

    def _check_positive(self, name: str) -> None:
        value = getattr(self, name)
        if value is not None and not (math.isfinite(value) and value > 0):
            raise InputError(f"{name} is {value}, must be positive.")

    def distance_for(self, camera: Camera) -> float:
        """Distance to the surface in metres, given or from the ground resolution."""
        if self.distance_m is not None:
            return self.distance_m
        assert self.gsd_m is not None
        return camera.distance_for_gsd(self.gsd_m)

    def smoothing_for(self, footprint_m: tuple[float, float]) -> float:
        """Standard deviation in metres of the smoothing for normals."""
        if self.smoothing_m is not None:
            return self.smoothing_m
        # A box of one footprint has a standard deviation of 1/sqrt(12) = 0.29 of its side.
        return 0.3 * math.sqrt(footprint_m[0] * footprint_m[1])
