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
from jfto_msgs_py.records.plan import Vector, Waypoint
from jfto_msgs_py.types import Array, Flags
from jfto_planner.coverage.camera import Camera, view_axes
from jfto_world.terrain import Dem

_SAMPLES_PER_SIDE = 300
# Beyond this angle between line of sight and the ground's normal a picture shows no detail.
_MAX_INCIDENCE_DEG = 75.0


@dataclass(frozen=True, eq=False)
class CoverageCertificate:
    """What of the area the photos show; shares are of the surface's area, not of its map.

    Ground resolution (m per pixel, at a plane facing the camera) is that of the finest photo of
    each spot, and the incidence (deg, 0 is frontal) that of the most frontal one; NaN when nothing
    is seen. `views` (ny, nx) counts photos per sample at `x_m`, `y_m`, of which those `inside` are
    of the area; `blind` lists the ids of waypoints whose photo shows nothing of the area.
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
    inside: Flags


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
        Of the grid of samples; None: 300 along the longer side, up to twice as many where the area
        fills little of its bounds.
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
    samples = _samples(dem, sample_spacing_m)
    shape = samples.inside.shape
    depth_max = math.inf if gsd_max_m is None else camera.distance_for_gsd(gsd_max_m)
    slant_max = depth_max * math.sqrt(1 + camera.half_width**2 + camera.half_height**2)

    views = np.zeros(shape, dtype=np.int32)
    depth = np.full(shape, np.inf)
    facing = np.zeros(shape)
    blind = []
    photos = [waypoint for waypoint in waypoints if waypoint.photo]
    for number, waypoint in enumerate(photos):
        block = samples.block(waypoint.position_m, slant_max)
        seen, depth_here, facing_here = _photo(
            waypoint, dem, camera, samples, block, max_incidence_deg, depth_max
        )
        if not seen.any():
            blind.append(waypoint.id)
        views[block] += seen
        depth[block] = np.where(seen, np.minimum(depth[block], depth_here), depth[block])
        facing[block] = np.where(seen, np.maximum(facing[block], facing_here), facing[block])
        if progress is not None:
            progress((number + 1) / len(photos))

    weight = samples.weight
    total = weight[samples.inside].sum()
    return CoverageCertificate(
        seen_once=float(weight[views >= 1].sum() / total),
        seen_twice=float(weight[views >= 2].sum() / total),
        **_spread(depth * camera.gsd_per_metre, facing, weight, views >= 1),
        surface_m2=samples.surface_m2(dem),
        blind=tuple(blind),
        x_m=samples.x_m,
        y_m=samples.y_m,
        views=views,
        inside=samples.inside,
    )


@dataclass(frozen=True, eq=False)
class _Samples:
    """Points of the ground at `y_m` × `x_m`, of which those `inside` belong to the area."""

    x_m: Array
    y_m: Array
    ground: Array
    normal: Array
    inside: Flags

    @property
    def weight(self) -> Array:
        """How much more surface than map there is at each."""
        return 1.0 / self.normal[..., 2]

    def block(self, position_m: Vector, reach_m: float) -> tuple[slice, slice]:
        """Rows and columns within reach of a place."""
        return _within(self.y_m, position_m[1], reach_m), _within(self.x_m, position_m[0], reach_m)

    def surface_m2(self, dem: Dem) -> float:
        """The area's surface."""
        box_m2 = dem.size_m[0] * dem.size_m[1]
        return float(self.weight[self.inside].mean() * self.inside.mean() * box_m2)


def _samples(dem: Dem, spacing_m: float | None) -> _Samples:
    if spacing_m is None:
        spacing_m = max(dem.size_m) / _SAMPLES_PER_SIDE
        if dem.area:
            filled = dem.area_shape.area / (dem.size_m[0] * dem.size_m[1])
            spacing_m *= min(1.0, max(0.5, math.sqrt(filled)))
    if not spacing_m > 0:
        raise InputError(f"sample_spacing_m is {spacing_m}, must be positive.")
    x, y = (_axis(side, spacing_m) for side in dem.size_m)
    grid_x, grid_y = np.meshgrid(x, y)
    inside = dem.in_area(grid_x, grid_y)
    if not inside.any():
        raise InputError(
            f"The area has no sample at a spacing of {spacing_m:.3g} m. Survey its parts one by "
            "one, or a wider area."
        )
    ground = np.stack([grid_x, grid_y, dem.height(grid_x, grid_y)], axis=-1)
    return _Samples(x, y, ground, dem.normal(grid_x, grid_y), inside)


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
    samples: _Samples,
    block: tuple[slice, slice],
    max_incidence_deg: float,
    depth_max: float,
) -> tuple[Flags, Array, Array]:
    """Which points one photo shows, their depth along its axis and cosine of incidence."""
    look, right, up = view_axes(waypoint)
    position = np.array(waypoint.position_m)
    ground = samples.ground[block]
    sight = ground - position
    depth = sight @ look
    facing = -np.einsum("...k,...k->...", sight, samples.normal[block])
    facing /= np.maximum(np.linalg.norm(sight, axis=-1), 1e-9)
    seen = (
        samples.inside[block]
        & (depth > 0)
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
