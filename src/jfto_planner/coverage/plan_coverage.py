"""Waypoints that photograph an area: equal distance, frontal view, given overlap."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy import ndimage

from jfto_msgs_py.errors import InfeasibleError
from jfto_msgs_py.records.plan import Vector, Waypoint
from jfto_msgs_py.types import Array
from jfto_planner.coverage.aim import aim
from jfto_planner.coverage.camera import Camera
from jfto_planner.coverage.certificate import CoverageCertificate, certify_coverage
from jfto_planner.coverage.settings import CoverageSettings
from jfto_planner.coverage.targets import gap_centres, surface_lattice
from jfto_world.terrain import CubicSurface, Dem

# A photo from further away than this multiple of the wished distance does not count as coverage.
_GSD_SLACK = 2.0
_FILL_ROUNDS = 10


@dataclass(frozen=True)
class CoverageNote:
    """What became of one photo that could not be taken as wished.

    `action` is "moved", "dropped" or "added"; `waypoint_id` is None for a dropped one.
    """

    action: str
    waypoint_id: int | None
    reason: str


@dataclass(frozen=True, eq=False)
class Coverage:
    """Waypoints, what they show, and what had to be changed; all lengths in metres.

    `certificate` counts only photos with at most twice the wished ground resolution.
    """

    waypoints: tuple[Waypoint, ...]
    certificate: CoverageCertificate
    notes: tuple[CoverageNote, ...]
    distance_m: float
    footprint_m: tuple[float, float]


def plan_coverage(
    dem: Dem,
    camera: Camera,
    settings: CoverageSettings,
    progress: Callable[[float], None] | None = None,
) -> Coverage:
    """Camera waypoints over the whole area of `dem`, certified by ray casting.

    Parameters
    ----------
    dem
        The ground.
    camera
        Sensor and lens.
    settings
        Overlaps, distance and limits.
    progress
        Called with the share done, 0 to 1.

    Returns
    -------
    Coverage
        Waypoints, what they show, and what had to be changed.

    Raises
    ------
    InfeasibleError
        No waypoint is possible, or more are needed than `settings.max_waypoints`.
    """
    distance_m = settings.distance_for(camera)
    footprint = camera.footprint_m(distance_m)
    surface = _smooth_surface(dem, settings.smoothing_for(footprint))
    along_x = _rows_run_east(surface, dem)
    placer = _Placer(dem, surface, distance_m, 0.0 if along_x else 90.0, settings)
    waypoints, notes = placer.place(_lattice(surface, dem, footprint, along_x, settings), 0, "")
    if not waypoints:
        raise InfeasibleError(
            f"No camera position is possible: {notes[0].reason} for all {len(notes)} waypoints.",
            cures=("another coverage.distance_m", "a smaller coverage.height_min_m"),
        )

    def certify(step: int) -> CoverageCertificate:
        def report(share: float) -> None:
            if progress is not None:
                progress((step + share) / (_FILL_ROUNDS + 1))

        gsd_max_m = _GSD_SLACK * camera.gsd_m(distance_m)
        return certify_coverage(waypoints, dem, camera, gsd_max_m=gsd_max_m, progress=report)

    certificate = certify(0)
    for step in range(1, _FILL_ROUNDS + 1):
        room = min(max(2, len(waypoints) // 10), settings.max_waypoints - len(waypoints))
        enough = certificate.seen_once >= settings.min_seen_once
        if enough or room <= 0 or not settings.fill_gaps:
            break
        gaps = gap_centres(certificate, min(footprint), room, 1 - settings.min_seen_once)
        more, more_notes = placer.place(gaps, len(waypoints), "the grid left ground here unseen")
        if not more:
            break
        waypoints, notes = waypoints + more, notes + more_notes
        certificate = certify(step)
    if progress is not None:
        progress(1.0)
    return Coverage(tuple(waypoints), certificate, tuple(notes), distance_m, footprint)


def judge_waypoints(
    waypoints: tuple[Waypoint, ...],
    dem: Dem,
    camera: Camera,
    distance_m: float,
    progress: Callable[[float], None] | None = None,
) -> Coverage:
    """Certificate of waypoints of any origin, by the rule of planned ones.

    Parameters
    ----------
    waypoints
        Where photos are taken, with yaw and pitch.
    dem
        The ground.
    camera
        Sensor and lens.
    distance_m
        Wished distance to the surface: photos of a ground resolution coarser than twice that of it
        do not count.
    progress
        Called with the share done, 0 to 1.

    Returns
    -------
    Coverage
        The waypoints as they are, and what they show.
    """
    gsd_max_m = _GSD_SLACK * camera.gsd_m(distance_m)
    found = certify_coverage(waypoints, dem, camera, gsd_max_m=gsd_max_m, progress=progress)
    return Coverage(waypoints, found, (), distance_m, camera.footprint_m(distance_m))


def _rows_run_east(surface: CubicSurface, dem: Dem) -> bool:
    """Whether slopes face north or south rather than east or west.

    A frontal camera's long side lies along the contour lines, and rows should run that way too.
    """
    x, y = (np.linspace(-side / 2, side / 2, 64) for side in dem.size_m)
    _, east, north = surface.height_and_gradient(*np.meshgrid(x, y))
    return bool((north**2).sum() >= (east**2).sum())


def _lattice(
    surface: CubicSurface,
    dem: Dem,
    footprint_m: tuple[float, float],
    along_x: bool,
    settings: CoverageSettings,
) -> Array:
    spacing = (
        (1 - settings.overlap_h) * footprint_m[0],
        (1 - settings.overlap_v) * footprint_m[1],
    )
    if along_x:
        return surface_lattice(surface, dem.size_m, spacing, settings.max_waypoints)
    turned = surface_lattice(
        surface.transposed(), (dem.size_m[1], dem.size_m[0]), spacing, settings.max_waypoints
    )
    return np.ascontiguousarray(turned[:, ::-1])


@dataclass(frozen=True)
class _Placer:
    """Turns points on the map into waypoints."""

    dem: Dem
    surface: CubicSurface
    distance_m: float
    heading_deg: float
    settings: CoverageSettings

    def place(
        self, points: Array, first_id: int, added: str
    ) -> tuple[list[Waypoint], list[CoverageNote]]:
        """Waypoints for points (K, 2), and notes on those changed, or `added` for that reason."""
        z, east, north = self.surface.height_and_gradient(points[:, 0], points[:, 1])
        normal = np.stack([-east, -north, np.ones_like(east)], axis=-1)
        normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
        target = np.column_stack([points, z])
        aimed = aim(self.dem, target, normal, self.distance_m, self.heading_deg, self.settings)
        waypoints: list[Waypoint] = []
        notes: list[CoverageNote] = []
        for k in range(len(points)):
            if not aimed.possible[k]:
                notes.append(CoverageNote("dropped", None, aimed.reason[k]))
                continue
            number = first_id + len(waypoints)
            waypoints.append(
                Waypoint(
                    number,
                    _vector(aimed.position_m[k]),
                    float(aimed.yaw_deg[k]),
                    float(aimed.pitch_deg[k]),
                )
            )
            if added:
                notes.append(CoverageNote("added", number, added))
            if aimed.reason[k]:
                gap_m = math.dist(_vector(aimed.position_m[k]), _vector(aimed.wished_m[k]))
                text = f"{aimed.reason[k]}; taken {gap_m:.0f} m from the place on the normal"
                notes.append(CoverageNote("moved", number, text))
        return waypoints, notes


def _vector(values: Array) -> Vector:
    x, y, z = (float(v) for v in values)
    return x, y, z


def _smooth_surface(dem: Dem, sigma_m: float) -> CubicSurface:
    """Bicubic surface of the ground after a Gaussian filter of standard deviation `sigma_m`."""
    x, y, z = dem.grid()
    step_x, step_y = float(x[1] - x[0]), float(y[1] - y[0])
    # Reflected oddly, a slope goes on beyond the edge instead of levelling out.
    reach = int(np.ceil(4 * sigma_m / min(step_x, step_y))) + 1
    padded = np.pad(z, reach, mode="reflect", reflect_type="odd")
    smooth = ndimage.gaussian_filter(padded, (sigma_m / step_y, sigma_m / step_x))
    inner = smooth[reach:-reach, reach:-reach]
    return CubicSurface.through(inner, float(x[0]), float(y[0]), step_x, step_y)
