"""A surface model over a terrain model: what is photographed, what must be cleared, what hides."""

from __future__ import annotations

import numpy as np
import pytest
import rasterio
from affine import Affine

from jfto.planning.scenario_file import load_scenario
from jfto.planning.terrain import load_ground
from jfto_msgs_py.errors import TerrainError
from jfto_msgs_py.records.plan import Waypoint
from jfto_planner.coverage import Camera, CoverageSettings, certify_coverage, plan_coverage
from jfto_planner.coverage.aim import height_above_ground

NORTH_WEST = (391_400.0, 5_117_900.0)
SCENARIO = """
/**:
  ros__parameters:
    terrain:
      source: ground.tif
      surface: {surface}
      size_m: [400.0, 400.0]
"""


def write(path, heights, cell, west=NORTH_WEST[0], north=NORTH_WEST[1]):
    options = {"driver": "GTiff", "count": 1, "dtype": "float32", "crs": "EPSG:25832+7837"}
    options |= {"height": heights.shape[0], "width": heights.shape[1]}
    options["transform"] = Affine(cell, 0, west, 0, -cell, north)
    with rasterio.open(path, "w", **options) as dataset:
        dataset.write(heights.astype(np.float32), 1)
    return path


def wall(heights):
    """A wood 30 m high and 60 m wide, from north to south east of the middle."""
    heights = heights.copy()
    heights[:, 660:720] += 30
    return heights


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Level ground of 10 m cells, and a surface of 1 m cells with a wood on it."""
    folder = tmp_path_factory.mktemp("surface")
    write(folder / "ground.tif", np.full((120, 120), 500.0), 10.0)
    bare = np.full((1200, 1200), 500.0)
    write(folder / "surface.tif", wall(bare), 1.0)
    write(folder / "narrow.tif", wall(bare)[330:870, 330:870], 1.0, 391_730.0, 5_117_570.0)
    write(folder / "elsewhere.tif", bare, 1.0, 491_750.0)
    write(folder / "feet.tif", bare / 0.3048, 1.0)
    write(folder / "lower.tif", wall(bare) - 3, 1.0)
    return folder


def ground(folder, surface):
    path = folder / f"{surface.split('.')[0]}.yaml"
    path.write_text(SCENARIO.format(surface=surface))
    return load_ground(load_scenario(path))


def test_ground_and_top_are_told_apart(folder):
    """Heights of the ground are the terrain model's, tops the higher of both, in one frame."""
    dem = ground(folder, "surface.tif")
    assert dem.origin.alt_m == pytest.approx(500.0, abs=0.01)
    x = np.array([-100.0, 90.0, 180.0])
    assert dem.height(x, 0 * x) == pytest.approx([0, 0, 0], abs=0.05)
    assert dem.top_height(x, 0 * x) == pytest.approx([0, 30, 0], abs=0.1)
    assert "surface" in dem.description
    assert "at most 3" in dem.description
    assert load_ground(load_scenario(folder / "surface.yaml")).top is not None


def test_without_a_surface_model_the_ground_is_the_top(folder):
    """The key is left out: nothing changes."""
    (folder / "plain.yaml").write_text(SCENARIO.format(surface='""'))
    dem = load_ground(load_scenario(folder / "plain.yaml"))
    assert dem.top is None
    assert dem.top_height(90.0, 0.0) == dem.height(90.0, 0.0)


def test_rays_end_at_what_stands_there_and_its_top_is_seen(folder):
    """From low in the west the wood hides the ground behind it; of the wood the crowns are seen."""
    dem = ground(folder, "surface.tif")
    west, high = [-50.0, 0.0, 15.0], [-50.0, 0.0, 300.0]
    behind, inside, before = [150.0, 0.0, 0.0], [70.0, 0.0, 0.0], [20.0, 0.0, 0.0]
    assert dem.sees([west] * 3, [behind, inside, before]).tolist() == [False, False, True]
    assert dem.sees([high] * 3, [behind, inside, before]).tolist() == [True, True, True]
    (hit,) = dem.first_hit([west], [[1.0, 0.0, 0.0]])
    assert hit == pytest.approx(110, abs=3)


def test_photos_are_placed_over_the_ground_and_clear_the_wood(folder):
    """Distance holds to the ground, height to the crowns, and what the wood hides is not seen."""
    dem = ground(folder, "surface.tif")
    camera = Camera(36.0, 24.0, 24.0, 6000, 4000)
    settings = CoverageSettings(0.3, 0.3, distance_m=60.0, gsd_m=None, min_height_m=20.0)
    found = plan_coverage(dem, camera, settings)
    places = np.array([waypoint.position_m for waypoint in found.waypoints])
    assert height_above_ground(dem, places, 0.0).min() >= 20.0
    assert places[:, 2].min() == pytest.approx(60.0, abs=0.5)
    assert found.certificate.seen_once > 0.97
    oblique = [Waypoint(0, (-20.0, 0.0, 40.0), 90.0, -20.0)]
    bare = ground_only(dem)
    shown = [certify_coverage(oblique, ground_, camera).seen_once for ground_ in (dem, bare)]
    assert shown[0] < 0.8 * shown[1]


def ground_only(dem):
    from dataclasses import replace

    return replace(dem, top=None)


def test_the_narrower_of_both_models_limits_the_margin(folder):
    """Neither is made up beyond what it holds."""
    wide, narrow = ground(folder, "surface.tif"), ground(folder, "narrow.tif")
    assert narrow.half_extent_m[0] < wide.half_extent_m[0]
    assert narrow.half_extent_m == pytest.approx((200 + 0.1 * 500,) * 2)
    assert narrow.top.contains(*np.array(narrow.half_extent_m))


@pytest.mark.parametrize(
    ("surface", "words"),
    [
        ("elsewhere.tif", "covers only 0 % of the area"),
        ("feet.tif", "lies 1140 m above the terrain model in half of the area"),
        ("none.tif", "does not exist"),
    ],
)
def test_models_of_two_places_are_refused(folder, surface, words):
    """Another place, other units, no file: scenario, key and cure are named."""
    with pytest.raises(TerrainError, match=words) as caught:
        ground(folder, surface)
    assert "terrain.surface: " in str(caught.value)
    assert str(caught.value).endswith(".")


def test_a_surface_below_the_ground_is_said(folder):
    """The ground is taken there, and how much is in a line."""
    dem = ground(folder, "lower.tif")
    assert dem.top_height(-100.0, 0.0) == pytest.approx(0.0, abs=0.01)
    assert any("m below the terrain model, at " in note for note in dem.notes)
