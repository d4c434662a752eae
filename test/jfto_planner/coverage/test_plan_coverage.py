import itertools
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from jfto_msgs_py.errors import InfeasibleError, InputError
from jfto_msgs_py.records.plan import Origin
from jfto_planner.coverage import Camera, CoverageSettings, plan_coverage
from jfto_planner.coverage.targets import surface_lattice
from jfto_world.terrain import CubicSurface, Dem, load_dem

CAMERA = Camera(35.9, 24.0, 24.0, 8192, 5460)
CENTER = (36.6301, -84.2626)


def make_dem(height, size=(400.0, 300.0), margin=400.0, step=10.0):
    """Ground of an analytic height(x, y), as a Dem."""
    half = (size[0] / 2 + margin, size[1] / 2 + margin)
    x, y = (np.arange(-h, h + step / 2, step) for h in half)
    surface = CubicSurface.through(height(*np.meshgrid(x, y)), x[0], y[0], step, step)
    origin = Origin(36.6, -84.2, 500.0)
    return Dem(origin, size, half, surface, "mean sea level", description="")


def tilted(slope):
    return make_dem(lambda x, y: slope * y + 0 * x)


def direction(waypoint):
    yaw, pitch = math.radians(waypoint.yaw_deg), math.radians(waypoint.pitch_deg)
    return np.array(
        [math.sin(yaw) * math.cos(pitch), math.cos(yaw) * math.cos(pitch), math.sin(pitch)]
    )


@pytest.mark.parametrize("slope", [0.0, 0.3, 0.8, 1.5])
def test_on_a_plane_photos_are_equidistant_frontal_and_overlap_as_asked(slope):
    """Over a slope: exact distance, view along the normal, spacing (1 - σ) footprint at most."""
    dem = tilted(slope)
    coverage = plan_coverage(
        dem, CAMERA, CoverageSettings(distance_m=60, overlap_h=0.3, overlap_v=0.4, min_height_m=10)
    )
    normal = np.array([0.0, -slope, 1.0]) / math.hypot(slope, 1.0)
    position = np.array([w.position_m for w in coverage.waypoints])
    assert position @ normal == pytest.approx(60.0, abs=1e-3)
    for waypoint in coverage.waypoints:
        assert direction(waypoint) == pytest.approx(-normal, abs=1e-6)
    across = np.unique(np.round(position[:, 1], 3))
    assert (np.diff(across) * math.hypot(1, slope) <= 0.6 * coverage.footprint_m[1] + 1e-2).all()
    along = np.sort(position[np.isclose(position[:, 1], position[0, 1], atol=1e-3), 0])
    assert (np.diff(along) <= 0.7 * coverage.footprint_m[0] + 1e-2).all()
    assert coverage.certificate.seen_once == 1.0
    assert coverage.certificate.gsd_p50_m == pytest.approx(CAMERA.gsd_m(60.0), rel=1e-2)
    assert not coverage.notes


def test_steeper_ground_gets_more_photos():
    """The grid is measured along the surface: photos grow as the surface does."""
    counts = [
        len(plan_coverage(tilted(s), CAMERA, CoverageSettings(distance_m=40)).waypoints)
        for s in (0.0, 0.75, 1.5)
    ]
    assert counts[0] < counts[1] < counts[2]
    assert counts[2] / counts[0] == pytest.approx(math.hypot(1, 1.5), rel=0.2)


@settings(deadline=None, derandomize=True, max_examples=20)
@given(st.floats(-1, 1), st.floats(-1, 1), st.floats(20, 80), st.floats(20, 80))
def test_lattice_spacing_holds_along_the_surface(east, north, along, across):
    """On any plane, neighbours of the lattice are no further apart than the spacing."""
    y, x = np.mgrid[-30:31, -30:31] * 20.0
    surface = CubicSurface.through(east * x + north * y, -600.0, -600.0, 20.0, 20.0)
    points = surface_lattice(surface, (800.0, 600.0), (along, across), 10_000)
    assert (np.abs(points) <= [400, 300]).all()
    z = surface.height_and_gradient(points[:, 0], points[:, 1])[0]
    place = np.column_stack([points, z])
    same_row = np.diff(points[:, 0]) > 0
    step = np.linalg.norm(np.diff(place, axis=0), axis=1)
    assert (step[same_row] <= along + 1e-6).all()
    rows = np.split(place, np.flatnonzero(~same_row) + 1)
    for low, high in itertools.pairwise(rows):
        rise = np.array([0.0, high[0, 1] - low[0, 1], north * (high[0, 1] - low[0, 1])])
        assert np.linalg.norm(rise) <= across + 1e-6


@pytest.mark.slow
def test_mountain_scene_of_two_kilometres():
    """The demo's ground: about 136 photos, all of it seen, 99 % at the wished resolution ± 10 %."""
    dem = load_dem("jacksboro", center=CENTER, size_m=(2000, 2000))
    shares = []
    coverage = plan_coverage(
        dem,
        CAMERA,
        CoverageSettings(distance_m=250, overlap_h=0.38, overlap_v=0.42),
        progress=shares.append,
    )
    certificate = coverage.certificate
    assert 125 <= len(coverage.waypoints) <= 145
    assert certificate.seen_once >= 0.99
    assert certificate.seen_twice >= 0.90
    assert certificate.gsd_p05_m >= 0.9 * CAMERA.gsd_m(250)
    assert certificate.gsd_p95_m <= 1.1 * CAMERA.gsd_m(250)
    assert [w.id for w in coverage.waypoints] == list(range(len(coverage.waypoints)))
    assert shares == sorted(shares)
    assert shares[-1] == 1.0
    again = plan_coverage(
        dem, CAMERA, CoverageSettings(distance_m=250, overlap_h=0.38, overlap_v=0.42)
    )
    assert again.waypoints == coverage.waypoints


@pytest.mark.slow
def test_gaps_of_a_thin_grid_are_filled_and_noted():
    """With hardly any overlap photos are added until 99 % is seen, each with a note."""
    dem = load_dem("jacksboro", center=CENTER, size_m=(1000, 1000))
    wish = {"distance_m": 110, "overlap_h": 0.1, "overlap_v": 0.1}
    thin = plan_coverage(dem, CAMERA, CoverageSettings(**wish, fill_gaps=False))
    filled = plan_coverage(dem, CAMERA, CoverageSettings(**wish))
    assert thin.certificate.seen_once < 0.99 <= filled.certificate.seen_once
    added = [note.waypoint_id for note in filled.notes if note.action == "added"]
    assert added == list(range(len(thin.waypoints), len(filled.waypoints)))


def test_narrow_gorges_move_photos_and_say_why():
    """Where the opposite wall is too near, photos move, keep their height and are noted."""
    gorge = make_dem(lambda x, y: 150 * np.tanh((np.abs(y) - 60) / 25) + 0 * x, size=(300.0, 300.0))
    wish = CoverageSettings(distance_m=120, min_height_m=40, smoothing_m=15)
    coverage = plan_coverage(gorge, CAMERA, wish)
    moved = [note for note in coverage.notes if note.action == "moved"]
    assert moved
    assert all("above the ground near it" in n.reason or "hide" in n.reason for n in moved)
    for waypoint in coverage.waypoints:
        angle = np.linspace(0, 2 * np.pi, 24)
        x = waypoint.position_m[0] + 29 * np.cos(angle)
        y = waypoint.position_m[1] + 29 * np.sin(angle)
        assert waypoint.position_m[2] - gorge.height(x, y).max() >= 39.0


def test_gimbal_limits_are_kept():
    """A gimbal that must look down 70° at least never gets a flatter wish; notes say so."""
    coverage = plan_coverage(
        tilted(1.0), CAMERA, CoverageSettings(distance_m=60, gimbal_pitch_max_deg=-70)
    )
    assert all(-90 <= w.pitch_deg <= -70 for w in coverage.waypoints)
    assert all("gimbal" in note.reason for note in coverage.notes)
    assert len(coverage.notes) == len(coverage.waypoints)


def test_no_possible_place_is_an_infeasible_wish():
    """A minimum height that no photo can keep is answered with reason and cures."""
    with pytest.raises(InfeasibleError, match="above the ground") as caught:
        plan_coverage(tilted(0.0), CAMERA, CoverageSettings(distance_m=50, min_height_m=500))
    assert caught.value.cures


def test_too_many_photos_are_an_infeasible_wish():
    """A resolution that needs more waypoints than allowed is refused before any is placed."""
    with pytest.raises(InfeasibleError, match="more than 5000"):
        plan_coverage(tilted(0.0), CAMERA, CoverageSettings(gsd_m=0.0001))


@pytest.mark.parametrize(
    "wish",
    [
        {},
        {"distance_m": 100, "gsd_m": 0.02},
        {"distance_m": -1},
        {"distance_m": math.nan},
        {"gsd_m": 0},
        {"distance_m": 100, "overlap_h": 1.0},
        {"distance_m": 100, "overlap_v": 0.0},
        {"distance_m": 100, "min_height_m": -1},
        {"distance_m": 100, "gimbal_pitch_min_deg": 10, "gimbal_pitch_max_deg": 0},
        {"distance_m": 100, "gimbal_pitch_min_deg": -100},
        {"distance_m": 100, "min_seen_once": 1.2},
        {"distance_m": 100, "smoothing_m": 0},
    ],
)
def test_contradictory_settings_are_refused(wish):
    """Each bad setting raises InputError that names it."""
    with pytest.raises(InputError) as caught:
        CoverageSettings(**wish)
    assert any(name in str(caught.value) for name in (*wish, "distance_m"))
