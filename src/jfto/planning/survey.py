"""First stage: the ground, and the waypoints over it."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from jfto.console.progress import SILENT, Progress
from jfto.planning.area import area_of
from jfto.planning.scenario_file import LoadedScenario
from jfto.planning.terrain import load_ground
from jfto_msgs_py.errors import WaypointError
from jfto_msgs_py.records.plan import Waypoint
from jfto_msgs_py.scenario.survey import CameraPart, CoveragePart
from jfto_msgs_py.types import Array
from jfto_planner.coverage import (
    Assumed,
    Camera,
    Coverage,
    CoverageSettings,
    Overlaps,
    judge_waypoints,
    plan_coverage,
    random_waypoints,
    read_waypoint_set,
)
from jfto_world.terrain import Dem


@dataclass(frozen=True)
class Survey:
    """Ground and waypoints; `coverage` is None where the waypoints were drawn at random.

    `notes` say in a line each what a file of waypoints holds that is not used. `starts_m` (S, 2)
    are starting points in the place of the scenario's, ENU, where a sortie has its own.
    """

    dem: Dem
    waypoints: tuple[Waypoint, ...]
    coverage: Coverage | None
    notes: tuple[str, ...] = ()
    starts_m: Array | None = None


def survey(loaded: LoadedScenario, progress: Progress = SILENT) -> Survey:
    """Waypoints of a scenario over its ground; raises InputError or InfeasibleError."""
    progress.begin("coverage", "reading terrain")
    dem = load_ground(loaded)
    for note in dem.notes:
        progress.warn(f"terrain: {note}")
    area = area_of(loaded)
    for note in area.notes if area else ():
        progress.warn(f"area: {note}")
    wanted = loaded.scenario.waypoints
    if wanted.source == "coverage":
        progress.begin("coverage", "placing cameras, casting rays")
        coverage = plan_coverage(
            dem,
            make_camera(loaded.scenario.camera, loaded.scenario.coverage),
            make_settings(loaded.scenario.coverage),
            progress=progress.advance,
        )
        found = Survey(dem, coverage.waypoints, coverage)
        progress.end("coverage", f"{len(found.waypoints)} waypoints", _proof(coverage))
        return found
    if wanted.source == "file":
        try:
            home_deg = (wanted.home_deg[0], wanted.home_deg[1]) if wanted.home_deg else None
            assumed = Assumed(home_deg, wanted.height_m)
            given = read_waypoint_set(loaded.resolve(wanted.file), dem, assumed)
        except WaypointError as error:
            raise WaypointError(f"{loaded.path}: waypoints.file: {error}") from None
        progress.begin("coverage", "casting rays")
        found = judged(Survey(dem, given.waypoints, None, given.notes), loaded, progress)
        assert found.coverage is not None
        proof = f"read from {wanted.file}, {_proof(found.coverage)}"
        progress.end("coverage", f"{len(found.waypoints)} waypoints", proof)
        for note in given.notes:
            progress.warn(note)
        return found
    rng = np.random.default_rng(wanted.seed)
    waypoints = random_waypoints(wanted.source, wanted.count, dem, wanted.height_m, rng)
    origin = f"{wanted.source} distribution, seed {wanted.seed}"
    progress.end("coverage", f"{len(waypoints)} waypoints", origin)
    return Survey(dem, waypoints, None)


def judged(found: Survey, loaded: LoadedScenario, progress: Progress = SILENT) -> Survey:
    """A survey with the certificate of what its photos show, whatever their origin."""
    if found.coverage is not None:
        return found
    scenario = loaded.scenario
    camera = make_camera(scenario.camera, scenario.coverage)
    settings = make_settings(scenario.coverage)
    coverage = judge_waypoints(found.waypoints, found.dem, camera, settings, progress.advance)
    return replace(found, coverage=coverage)


def make_camera(camera: CameraPart, coverage: CoveragePart) -> Camera:
    """The planner's camera of a scenario."""
    width_px, height_px = camera.image_px
    if camera.footprint_m:
        width_m, height_m = camera.footprint_m
        return Camera.from_footprint(width_m, height_m, coverage.distance_m, width_px, height_px)
    width_mm, height_mm = camera.sensor_mm
    return Camera(width_mm, height_mm, camera.focal_length_mm, width_px, height_px)


def make_settings(coverage: CoveragePart) -> CoverageSettings:
    """The planner's coverage settings of a scenario."""
    given = coverage.distance_m > 0
    return CoverageSettings(
        overlap_h=coverage.overlap_h,
        overlap_v=coverage.overlap_v,
        distance_m=coverage.distance_m if given else None,
        gsd_m=None if given else coverage.gsd_cm / 100,
        min_height_m=coverage.height_min_m,
        clearance_radius_m=coverage.clearance_radius_m,
        gimbal_pitch_min_deg=coverage.pitch_min_deg,
        gimbal_pitch_max_deg=coverage.pitch_max_deg,
        fill_gaps=coverage.fill_gaps,
        heading_deg=None if coverage.heading_deg < 0 else coverage.heading_deg,
        crosshatch=coverage.crosshatch,
    )


def _proof(coverage: Coverage) -> str:
    certificate = coverage.certificate
    if certificate.seen_once == 0:
        return "nothing of the area seen"
    spread = 100 * certificate.gsd_std_m / certificate.gsd_mean_m
    changed = sum(note.action != "added" for note in coverage.notes)
    return (
        f"{100 * certificate.seen_once:.1f} % of the area seen, "
        f"{100 * certificate.seen_twice:.1f} % twice, "
        f"{100 * certificate.gsd_mean_m:.1f} cm/px ± {spread:.0f} %"
        + (f", {changed} moved or dropped" if changed else "")
        + f", {_overlap(coverage.overlaps)}"
    )


def _overlap(found: Overlaps) -> str:
    """Of the overlaps, what a line has room for."""
    pairs = found.across.pairs + found.along.pairs
    if not pairs:
        return "no photos beside one another"
    return f"overlap short at {found.below} of {pairs} pairs"
