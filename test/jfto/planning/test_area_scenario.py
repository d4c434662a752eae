"""Areas from scenario to plan: window, frame, and the plan's own record of what is to be seen."""

from pathlib import Path

import pytest
import shapely

from jfto.pipeline.directory import write_scenario
from jfto.planning.routes import plan_routes
from jfto.planning.scenario_file import load_scenario
from jfto.planning.survey import survey
from jfto.planning.terrain import load_ground
from jfto_msgs_py.errors import SiteError
from jfto_msgs_py.plan_file import read_plan, write_plan
from jfto_world.site import as_shapely

DATA = Path(__file__).parents[2] / "data"
TINY = DATA / "scenario" / "tiny.yaml"
U_SHAPE = f"area.file={DATA / 'area' / 'u_shape.geojson'}"


@pytest.fixture
def free(tmp_path):
    """tiny.yaml without centre and size."""
    lines = [
        line
        for line in TINY.read_text().splitlines()
        if "center_deg" not in line and "size_m" not in line
    ]
    path = tmp_path / "free.yaml"
    path.write_text("\n".join(lines).replace("terrain:", "terrain: {source: jacksboro}") + "\n")
    return path


def test_the_ground_follows_from_the_area(free):
    """Without centre and size the frame sits in the middle of the area, the window holds it."""
    dem = load_ground(load_scenario(free, [U_SHAPE]))
    west, south, east, north = as_shapely(dem.area).bounds
    assert (west + east, south + north) == pytest.approx((0, 0), abs=0.2)
    assert (east - west, north - south) == pytest.approx((600, 400), abs=0.3)
    assert dem.size_m == pytest.approx((600, 400), rel=3e-3)
    assert (dem.origin.lat_deg, dem.origin.lon_deg) == pytest.approx((36.6255, -84.265), abs=1e-5)


def test_centre_and_size_win_where_they_are_given(free):
    """terrain.center_deg places the frame; terrain.size_m must hold the area."""
    center = "terrain.center_deg=[36.6265,-84.265]"
    dem = load_ground(load_scenario(free, [U_SHAPE, center]))
    assert dem.origin.lat_deg == 36.6265
    assert dem.size_m[1] == pytest.approx(400 + 2 * 111, abs=2)
    wide = load_ground(load_scenario(free, [U_SHAPE, center, "terrain.size_m=[900,900]"]))
    assert wide.size_m == (900.0, 900.0)
    with pytest.raises(SiteError, match=r"needs \d+ m × \d+ m about .* terrain.size_m is 500 m"):
        load_ground(load_scenario(free, [U_SHAPE, "terrain.size_m=[500,500]"]))


def test_a_plan_says_what_is_to_be_seen(free, tmp_path):
    """The plan's area is the polygon, there and back; drawn waypoints lie in it."""
    loaded = load_scenario(free, [U_SHAPE, "area.buffer_m=5"])
    found = survey(loaded)
    shape = found.dem.area_shape
    assert all(shape.contains(shapely.Point(w.position_m[:2])) for w in found.waypoints)
    plan = plan_routes(loaded.scenario, found).plan
    write_plan(plan, tmp_path / "plan.json")
    assert read_plan(tmp_path / "plan.json").area == plan.area
    assert as_shapely(plan.area).symmetric_difference(shape).area < 0.01
    rectangle = load_scenario(free)
    assert load_ground(rectangle).area == ()
    assert load_ground(rectangle).size_m == (2000.0, 2000.0)


def test_a_written_scenario_stands_alone(free, tmp_path):
    """The scenario of a run names the area's file by its whole path and gives the same ground."""
    loaded = load_scenario(free, [U_SHAPE])
    (tmp_path / "run").mkdir()
    write_scenario(loaded, tmp_path / "run" / "scenario.yaml")
    again = load_scenario(tmp_path / "run" / "scenario.yaml")
    assert load_ground(again).area == load_ground(loaded).area
    assert again.scenario.scenario_hash() != load_scenario(free).scenario.scenario_hash()
