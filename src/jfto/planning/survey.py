"""First stage: the ground, and the waypoints over it."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from jfto.console.progress import SILENT, Progress
from jfto.planning.area import area_of
from jfto.planning.fence import corner_allowance_m, fence_of
from jfto.planning.scenario_file import LoadedScenario
from jfto.planning.terrain import load_ground
from jfto_msgs_py.errors import InfeasibleError, WaypointError
from jfto_msgs_py.records.plan import Waypoint
from jfto_msgs_py.records.site import Fence
from jfto_msgs_py.scenario import Scenario
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
    are starting points in the place of the scenario's, ENU, where a sortie has its own. `fence` is
    where may be flown, None where nobody says.
    """

    dem: Dem
    waypoints: tuple[Waypoint, ...]
    coverage: Coverage | None
    notes: tuple[str, ...] = ()
    starts_m: Array | None = None
    fence: Fence | None = None


def survey(loaded: LoadedScenario, progress: Progress = SILENT) -> Survey:
    """Waypoints of a scenario over its ground; raises InputError or InfeasibleError.

    Those in no-fly zones, or too near to one, are left out, unless they come from a file.
    """
    progress.begin("coverage", "reading terrain")
    dem = load_ground(loaded)
    for note in dem.notes:
        progress.warn(f"terrain: {note}")
    area = area_of(loaded)
    for note in area.notes if area else ():
        progress.warn(f"area: {note}")
    fence, notes = fence_of(loaded, dem)
    for note in notes:
        progress.warn(f"fence: {note}")
    found = _waypoints(loaded, dem, progress)
    return found if fence is None else within(replace(found, fence=fence), loaded, progress)


def _waypoints(loaded: LoadedScenario, dem: Dem, progress: Progress) -> Survey:
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
        found = judged(Survey(dem, given.waypoints, None, given.notes), loaded.scenario, progress)
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


def within(found: Survey, loaded: LoadedScenario, progress: Progress = SILENT) -> Survey:
    """The survey without the waypoints that its fence does not allow, and what is seen then.

    Raises WaypointError where they come from a file, InfeasibleError where none is left.
    """
    assert found.fence is not None
    # Loads shapely, which only plans with a fence need.
    from jfto_world.site.free_space import FreeSpace

    free = FreeSpace(found.fence, corner_allowance_m(loaded.scenario.trajectory))
    zones = free.inside(np.array([waypoint.position_m for waypoint in found.waypoints]))
    kept = tuple(w for w, zone in zip(found.waypoints, zones, strict=True) if not zone)
    if len(kept) == len(found.waypoints):
        return found
    inside = [(w.id, zone) for w, zone in zip(found.waypoints, zones, strict=True) if zone]
    names = ", ".join(f"waypoint {number} in {zone}" for number, zone in inside[:5])
    names += f" and {len(inside) - 5} more" if len(inside) > 5 else ""
    if loaded.scenario.waypoints.source == "file":
        raise WaypointError(
            f"{loaded.path}: waypoints.file: {names} must not be flown to (fence, with "
            f"fence.margin_m {found.fence.margin_m:g}). Take them out, or change the fence."
        )
    if not kept:
        raise InfeasibleError(
            f"All {len(inside)} waypoints lie in no-fly zones or outside of fence.keep_in: "
            f"{names}.",
            cures=("a smaller zone or fence.margin_m", "another area"),
        )
    progress.warn(f"fence: {len(inside)} of {len(found.waypoints)} waypoints are left out: {names}")
    if found.coverage is None:
        return replace(found, waypoints=kept)
    seen = judged(replace(found, waypoints=kept, coverage=None), loaded.scenario, progress)
    assert seen.coverage is not None
    progress.end("coverage", f"{len(kept)} waypoints", _proof(seen.coverage))
    return seen


def judged(found: Survey, scenario: Scenario, progress: Progress = SILENT) -> Survey:
    """A survey with the certificate of what its photos show, whatever their origin."""
    if found.coverage is not None:
        return found
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
