"""What a set of photos shows of the area, found by ray casting from the photos alone.

Knows nothing of how the waypoints came about, so that a user's own can be judged as well.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from jfto_msgs_py.errors import InputError
from jfto_msgs_py.records.plan import Waypoint
from jfto_msgs_py.types import Array, Flags
from jfto_planner.coverage.camera import Camera
from jfto_world.terrain import Dem

_SAMPLES_PER_SIDE = 300
# Beyond this angle between line of sight and the ground's normal a picture shows no detail.
_MAX_INCIDENCE_DEG = 75.0


@dataclass(frozen=True, eq=False)
class CoverageCertificate:
    """What of the area the photos show; shares are of the surface's area, not of its map.

    Ground resolution (m per pixel, at a plane facing the camera) is that of the finest photo of
    each spot, and the incidence (deg, 0 is frontal) that of the most frontal one; NaN when nothing
    is seen. `views` (ny, nx) counts photos per sample at `x_m`, `y_m`; `blind` lists the ids of
    waypoints whose photo shows nothing of the area.
    """

    seen_once: float
    seen_twice: float
    gsd_mean_m: float
    gsd_std_m: float
    gsd_p05_m: float
    gsd_p50_m: float
    gsd_p95_m: float
    incidence_mean_deg: float
    incidence_p95_deg: float
    surface_m2: float
    blind: tuple[int, ...]
    x_m: Array
    y_m: Array
    views: NDArray[np.int32]


def certify_coverage(
    waypoints: Sequence[Waypoint],
    dem: Dem,
    camera: Camera,
    *,
    gsd_max_m: float | None = None,
    max_incidence_deg: float = _MAX_INCIDENCE_DEG,
    sample_spacing_m: float | None = None,
    progress: Callable[[float], None] | None = None,
) -> CoverageCertificate:
    """Cast a ray from every photo to every sample of the area inside its frame.

    A sample is seen when it is inside the frame, faces the camera, is not hidden by ground and is
    near enough.

    Parameters
    ----------
    waypoints
        Where photos are taken, with yaw and pitch.
    dem
        The ground.
    camera
        Sensor and lens.
    gsd_max_m
        Coarsest ground resolution that counts, m per pixel; None: any.
    max_incidence_deg
        Greatest angle to the normal of the ground.
    sample_spacing_m
        Of the grid of samples; None: 300 along the longer side.
    progress
        Called with the share done, 0 to 1.

    Returns
    -------
    CoverageCertificate
        What the photos show.

    Raises
    ------
    InputError
        An argument is out of range.
    """
    if sample_spacing_m is None:
        sample_spacing_m = max(dem.size_m) / _SAMPLES_PER_SIDE
    if not sample_spacing_m > 0:
        raise InputError(f"sample_spacing_m is {sample_spacing_m}, must be positive.")
    x, y = (_axis(side, sample_spacing_m) for side in dem.size_m)
    shape = (len(y), len(x))
    grid_x, grid_y = np.meshgrid(x, y)
    ground = np.stack([grid_x, grid_y, dem.height(grid_x, grid_y)], axis=-1)
    normal = dem.normal(grid_x, grid_y)
    depth_max = math.inf if gsd_max_m is None else camera.distance_for_gsd(gsd_max_m)
    slant_max = depth_max * math.sqrt(1 + camera.half_width**2 + camera.half_height**2)

    views = np.zeros(shape, dtype=np.int32)
    depth = np.full(shape, np.inf)
    facing = np.zeros(shape)
    blind = []
    for number, waypoint in enumerate(waypoints):
        rows = _within(y, waypoint.position_m[1], slant_max)
        columns = _within(x, waypoint.position_m[0], slant_max)
        block = (rows, columns)
        seen, depth_here, facing_here = _photo(
            waypoint, dem, camera, ground[block], normal[block], max_incidence_deg, depth_max
        )
        if not seen.any():
            blind.append(waypoint.id)
        views[block] += seen
        depth[block] = np.where(seen, np.minimum(depth[block], depth_here), depth[block])
        facing[block] = np.where(seen, np.maximum(facing[block], facing_here), facing[block])
        if progress is not None:
            progress((number + 1) / len(waypoints))

    weight = 1.0 / normal[..., 2]
    return CoverageCertificate(
        seen_once=float(weight[views >= 1].sum() / weight.sum()),
        seen_twice=float(weight[views >= 2].sum() / weight.sum()),
        **_spread(depth * camera.gsd_per_metre, facing, weight, views >= 1),
        surface_m2=float(weight.mean() * dem.size_m[0] * dem.size_m[1]),
        blind=tuple(blind),
        x_m=x,
        y_m=y,
        views=views,
    )


def _axis(side_m: float, spacing_m: float) -> Array:
    """Middles of equal parts of one side of the area."""
    parts = max(2, math.ceil(side_m / spacing_m))
    return ((np.arange(parts) + 0.5) / parts - 0.5) * side_m


def _within(axis: Array, centre: float, reach: float) -> slice:
    return slice(
        int(np.searchsorted(axis, centre - reach)), int(np.searchsorted(axis, centre + reach))
    )


def _photo(
    waypoint: Waypoint,
    dem: Dem,
    camera: Camera,
    ground: Array,
    normal: Array,
    max_incidence_deg: float,
    depth_max: float,
) -> tuple[Flags, Array, Array]:
    """Which ground points one photo shows, their depth along its axis and cosine of incidence."""
    yaw, pitch = math.radians(waypoint.yaw_deg), math.radians(waypoint.pitch_deg)
    look = np.array(
        [math.sin(yaw) * math.cos(pitch), math.cos(yaw) * math.cos(pitch), math.sin(pitch)]
    )
    right = np.array([math.cos(yaw), -math.sin(yaw), 0.0])
    up = np.cross(right, look)
    position = np.array(waypoint.position_m)
    sight = ground - position
    depth = sight @ look
    facing = -np.einsum("...k,...k->...", sight, normal)
    facing /= np.maximum(np.linalg.norm(sight, axis=-1), 1e-9)
    seen = (
        (depth > 0)
        & (depth <= depth_max)
        & (np.abs(sight @ right) <= camera.half_width * depth)
        & (np.abs(sight @ up) <= camera.half_height * depth)
        & (facing >= math.cos(math.radians(max_incidence_deg)))
    )
    seen[seen] = dem.sees(position, ground[seen]) if seen.any() else True
    return seen, depth, facing


def _spread(gsd_m: Array, facing: Array, weight: Array, seen: Flags) -> dict[str, float]:
    """Means and percentiles over the seen surface, weighted by its area."""
    names = ("mean_m", "std_m", "p05_m", "p50_m", "p95_m")
    incidence_names = ("incidence_mean_deg", "incidence_p95_deg")
    if not seen.any():
        return dict.fromkeys([*(f"gsd_{name}" for name in names), *incidence_names], math.nan)
    gsd, share = gsd_m[seen], weight[seen] / weight[seen].sum()
    incidence = np.degrees(np.arccos(np.clip(facing[seen], -1, 1)))
    mean = float(share @ gsd)
    return {
        "gsd_mean_m": mean,
        "gsd_std_m": math.sqrt(float(share @ (gsd - mean) ** 2)),
        "gsd_p05_m": _percentile(gsd, share, 0.05),
        "gsd_p50_m": _percentile(gsd, share, 0.50),
        "gsd_p95_m": _percentile(gsd, share, 0.95),
        "incidence_mean_deg": float(share @ incidence),
        "incidence_p95_deg": _percentile(incidence, share, 0.95),
    }


def _percentile(values: Array, share: Array, level: float) -> float:
    order = np.argsort(values, kind="stable")
    place = int(np.searchsorted(np.cumsum(share[order]), level))
    return float(values[order[min(place, len(values) - 1)]])
