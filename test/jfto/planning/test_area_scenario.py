"""Areas from scenario to plan: window, frame, and the plan's own record of what is to be seen."""

from pathlib import Path

import pytest
import shapely
from matplotlib import pyplot as plt

from jfto.cli import main
from jfto.pipeline.directory import write_scenario
from jfto.planning.check import check_plan
from jfto.planning.routes import plan_routes
from jfto.planning.scenario_file import load_scenario
from jfto.planning.survey import survey
from jfto.planning.terrain import load_ground
from jfto.reporting.figures.map import area_rings, draw_relief
from jfto.reporting.scene import on_ground
from jfto_msgs_py.errors import SiteError
from jfto_msgs_py.plan_file import read_plan, write_plan
from jfto_world.site import as_shapely

DATA = Path(__file__).parents[2] / "data"
WANGHAI = DATA.parents[1] / "config" / "wanghai_area.geojson"
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


@pytest.mark.slow
def test_check_says_what_photos_show_of_the_area(free, tmp_path, capsys):
    """The plan's own area is judged, pair by pair too, where the scenario's ground is at hand."""
    overrides = ["waypoints.source=coverage", "area.buffer_m=-55", U_SHAPE]
    loaded = load_scenario(free, overrides)
    plan = plan_routes(loaded.scenario, survey(loaded)).plan
    (tmp_path / "run").mkdir()
    write_plan(plan, tmp_path / "run" / "plan.json")
    write_scenario(loaded, tmp_path / "run" / "scenario.yaml")
    checked = check_plan(tmp_path / "run" / "plan.json")
    assert checked.coverage is not None
    assert checked.coverage.certificate.seen_once >= 0.99
    area_m2 = checked.coverage.certificate.inside.mean() * loaded_box_m2(loaded)
    assert area_m2 == pytest.approx(as_shapely(plan.area).area, rel=0.02)
    main(["check", str(tmp_path / "run" / "plan.json")])
    said = capsys.readouterr().out
    assert "area seen" in said
    assert "overlap σ_v" in said


def loaded_box_m2(loaded):
    east, north = load_ground(loaded).size_m
    return east * north


def test_the_outline_is_drawn_in_maps_and_in_three_dimensions(free):
    """Maps have a line per ring, labelled once; the 3-D view has rings that lie on the ground."""
    dem = load_ground(load_scenario(free, [f"area.file={WANGHAI}"]))
    figure, axes = plt.subplots()
    draw_relief(axes, dem, (400.0, 300.0))
    rings = [line for line in axes.get_lines() if line.get_zorder() == 2]
    assert [line.get_label() == "area" for line in rings] == [True, False]
    plt.close(figure)
    line = on_ground(area_rings(dem.area)[1], dem)
    assert line[:, 2] - dem.height(line[:, 0], line[:, 1]) == pytest.approx(2.0)
    assert tuple(line[0]) == tuple(line[-1])


def test_a_written_scenario_stands_alone(free, tmp_path):
    """The scenario of a run names the area's file by its whole path and gives the same ground."""
    loaded = load_scenario(free, [U_SHAPE])
    (tmp_path / "run").mkdir()
    write_scenario(loaded, tmp_path / "run" / "scenario.yaml")
    again = load_scenario(tmp_path / "run" / "scenario.yaml")
    assert load_ground(again).area == load_ground(loaded).area
    assert again.scenario.scenario_hash() != load_scenario(free).scenario.scenario_hash()
