"""Waypoints that photograph an area: equal distance, frontal view, given overlap."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial import cKDTree

from jfto_msgs_py.errors import InfeasibleError
from jfto_msgs_py.records.plan import Waypoint
from jfto_msgs_py.types import Array
from jfto_planner.coverage.area_lattice import area_lattice
from jfto_planner.coverage.camera import Camera
from jfto_planner.coverage.certificate import CoverageCertificate, certify_coverage
from jfto_planner.coverage.headings import likely_headings, rows_run_east
from jfto_planner.coverage.overlaps import Overlaps, measure_overlaps
from jfto_planner.coverage.placer import CoverageNote, Placer, smooth_surface
from jfto_planner.coverage.settings import CoverageSettings
from jfto_planner.coverage.targets import gap_centres, surface_lattice
from jfto_world.terrain import Dem

# A photo from further away than this multiple of the wished distance does not count as coverage.
_GSD_SLACK = 2.0
_FILL_ROUNDS = 10
# Nearer than this a photo of the second grid would be one of the first again.
_SAME_M = 1.0

Report = Callable[[float], None]


@dataclass(frozen=True, eq=False)
class Coverage:
    """Waypoints, what they show, and what had to be changed; all lengths in metres.

    `certificate` counts only photos with at most twice the wished ground resolution. `heading_deg`
    is the direction of the grid's rows, None where there is no grid.
    """

    waypoints: tuple[Waypoint, ...]
    certificate: CoverageCertificate
    overlaps: Overlaps
    notes: tuple[CoverageNote, ...]
    distance_m: float
    footprint_m: tuple[float, float]
    heading_deg: float | None = None


def plan_coverage(
    dem: Dem,
    camera: Camera,
    settings: CoverageSettings,
    progress: Report | None = None,
) -> Coverage:
    """Camera waypoints over the whole area of `dem`, certified by ray casting.

    Parameters
    ----------
    dem
        The ground and its area.
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
    grid = _Grid(dem, camera, settings)
    headings = grid.headings()
    report = progress or (lambda _: None)
    found = []
    for number, heading in enumerate(headings):

        def partly(share: float, number: int = number) -> None:
            report((number + share) / len(headings))

        found.append(grid.attempt(heading, partly))
    report(1.0)
    best = min(found, key=lambda one: one.rank(settings.min_seen_once))
    return Coverage(
        tuple(best.waypoints),
        best.certificate,
        best.overlaps,
        tuple(best.notes),
        grid.distance_m,
        grid.footprint_m,
        best.heading_deg,
    )


def judge_waypoints(
    waypoints: tuple[Waypoint, ...],
    dem: Dem,
    camera: Camera,
    settings: CoverageSettings,
    progress: Report | None = None,
) -> Coverage:
    """Certificate of waypoints of any origin, by the rule of planned ones.

    Parameters
    ----------
    waypoints
        Where photos are taken, with yaw and pitch.
    dem
        The ground and its area.
    camera
        Sensor and lens.
    settings
        Overlaps wished for, and the wished distance to the surface: photos of a ground resolution
        coarser than twice that of it do not count.
    progress
        Called with the share done, 0 to 1.

    Returns
    -------
    Coverage
        The waypoints as they are, and what they show.
    """
    distance_m = settings.distance_for(camera)
    gsd_max_m = _GSD_SLACK * camera.gsd_m(distance_m)
    found = certify_coverage(waypoints, dem, camera, gsd_max_m=gsd_max_m, progress=progress)
    overlaps = measure_overlaps(waypoints, dem, camera, settings.overlaps)
    return Coverage(waypoints, found, overlaps, (), distance_m, camera.footprint_m(distance_m))


@dataclass(frozen=True, eq=False)
class _Attempt:
    """What a grid of one heading came to."""

    heading_deg: float
    waypoints: list[Waypoint]
    certificate: CoverageCertificate
    overlaps: Overlaps
    notes: list[CoverageNote]

    def rank(self, min_seen_once: float) -> tuple[bool, int, float]:
        """Less is better: enough seen, then few waypoints, then much seen twice.

        A pair that falls short of its overlap counts as the waypoint that would be needed between.
        """
        enough = self.certificate.seen_once >= min_seen_once
        cost = len(self.waypoints) + self.overlaps.below
        return not enough, cost, -self.certificate.seen_twice


class _Grid:
    """Grids of photos over an area, in any direction."""

    def __init__(self, dem: Dem, camera: Camera, settings: CoverageSettings) -> None:
        self._dem, self._camera, self._settings = dem, camera, settings
        self.distance_m = settings.distance_for(camera)
        self.footprint_m = camera.footprint_m(self.distance_m)
        self._surface = smooth_surface(dem, settings.smoothing_for(self.footprint_m))
        self._spacing_m = (
            (1 - settings.overlap_h) * self.footprint_m[0],
            (1 - settings.overlap_v) * self.footprint_m[1],
        )

    def headings(self) -> Sequence[float]:
        """Directions of rows to try: the one that is wished for, or that of a rectangle."""
        wished = self._settings.heading_deg
        if wished is not None:
            return (wished % 360.0,)
        if not self._dem.area:
            return (90.0 if rows_run_east(self._surface, self._dem) else 0.0,)
        return likely_headings(
            self._surface, self._dem, lambda heading: len(self._turned_points(heading))
        )

    def attempt(self, heading_deg: float, report: Report) -> _Attempt:
        """A grid with rows of this heading, its gaps filled. Raises InfeasibleError."""
        settings = self._settings
        placer = self._placer(heading_deg)
        waypoints, notes = placer.place(self._points(heading_deg), 0, "")
        if settings.crosshatch:
            across = self._across(heading_deg + 90.0, waypoints)
            more, more_notes = self._placer(heading_deg + 90.0).place(across, len(waypoints), "")
            waypoints, notes = waypoints + more, notes + more_notes
        if not waypoints:
            raise InfeasibleError(
                f"No camera position is possible: {notes[0].reason} for all {len(notes)} "
                "waypoints.",
                cures=("another coverage.distance_m", "a smaller coverage.height_min_m"),
            )
        certificate = self._certify(waypoints, 0, report)
        if self._dem.area and certificate.blind:
            waypoints, notes = _without_blind(waypoints, notes, certificate.blind)
            certificate = replace(certificate, blind=())
        for step in range(1, _FILL_ROUNDS + 1):
            room = min(max(2, len(waypoints) // 10), settings.max_waypoints - len(waypoints))
            enough = certificate.seen_once >= settings.min_seen_once
            if enough or room <= 0 or not settings.fill_gaps:
                break
            may_stay = 1 - settings.min_seen_once
            gaps = gap_centres(certificate, min(self.footprint_m), room, may_stay)
            more, more_notes = placer.place(
                gaps, len(waypoints), "the grid left ground here unseen"
            )
            if not more:
                break
            waypoints, notes = waypoints + more, notes + more_notes
            certificate = self._certify(waypoints, step, report)
        overlaps = measure_overlaps(waypoints, self._dem, self._camera, settings.overlaps)
        return _Attempt(heading_deg, waypoints, certificate, overlaps, notes)

    def _placer(self, heading_deg: float) -> Placer:
        # Level ground is photographed with the image's long side along the rows.
        up_deg = (heading_deg - 90.0) % 180.0
        return Placer(self._dem, self._surface, self.distance_m, up_deg, self._settings)

    def _points(self, heading_deg: float) -> Array:
        """Points (W, 2) of the grid; a whole rectangle along its sides is cut evenly."""
        if self._dem.area or heading_deg not in (0.0, 90.0):
            return self._turned_points(heading_deg)
        size, most = self._dem.size_m, self._settings.max_waypoints
        if heading_deg == 90.0:
            return surface_lattice(self._surface, size, self._spacing_m, most)
        turned = surface_lattice(self._surface.transposed(), size[::-1], self._spacing_m, most)
        return np.ascontiguousarray(turned[:, ::-1])

    def _turned_points(self, heading_deg: float) -> Array:
        return area_lattice(
            self._surface,
            self._dem.area_shape,
            heading_deg,
            self._spacing_m,
            self._settings.max_waypoints,
        )

    def _across(self, heading_deg: float, waypoints: list[Waypoint]) -> Array:
        """Points of the second grid, without those that the first has."""
        points = self._turned_points(heading_deg)
        if not waypoints:
            return points
        taken = np.array([waypoint.position_m[:2] for waypoint in waypoints])
        far, _ = cKDTree(taken).query(points)
        return points[far > _SAME_M]

    def _certify(self, waypoints: list[Waypoint], step: int, report: Report) -> CoverageCertificate:
        return certify_coverage(
            waypoints,
            self._dem,
            self._camera,
            gsd_max_m=_GSD_SLACK * self._camera.gsd_m(self.distance_m),
            progress=lambda share: report((step + share) / (_FILL_ROUNDS + 1)),
        )


def _without_blind(
    waypoints: list[Waypoint], notes: list[CoverageNote], blind: tuple[int, ...]
) -> tuple[list[Waypoint], list[CoverageNote]]:
    """Waypoints whose photos show some of the area, numbered anew."""
    kept = [waypoint for waypoint in waypoints if waypoint.id not in blind]
    number = {waypoint.id: index for index, waypoint in enumerate(kept)}
    said = [
        replace(note, waypoint_id=None if note.waypoint_id is None else number[note.waypoint_id])
        for note in notes
        if note.waypoint_id not in blind
    ]
    return [replace(waypoint, id=number[waypoint.id]) for waypoint in kept], said
