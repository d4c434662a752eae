"""Fences from scenario to plan: files, heights, and what is refused by name."""

import json
from pathlib import Path

import numpy as np
import pytest

from jfto.pipeline.directory import write_scenario
from jfto.planning.fence import fence_of
from jfto.planning.routes import plan_routes
from jfto.planning.scenario_file import load_scenario
from jfto.planning.survey import survey
from jfto.planning.terrain import load_ground
from jfto_msgs_py.errors import InfeasibleError, JftoError, SiteError, WaypointError
from jfto_msgs_py.plan_file import read_plan, write_plan

TINY = Path(__file__).parents[2] / "data" / "scenario" / "tiny.yaml"


def box(dem, east, north, half):
    """Corners of a square about a place (ENU), as longitude and latitude."""
    sides = ((-1, -1), (1, -1), (1, 1), (-1, 1), (-1, -1))
    ring = np.array([[east + half * x, north + half * y, 0.0] for x, y in sides])
    lat, lon, _ = dem.to_geodetic(ring)
    return [[float(b), float(a)] for a, b in zip(lat, lon, strict=True)]


def scenario(*overrides):
    """tiny.yaml with overrides."""
    return load_scenario(TINY, list(overrides))


@pytest.fixture
def dem():
    """The ground of tiny.yaml."""
    return load_ground(scenario())


def zone_text(dem, east, north, half, more=""):
    """A square zone as a line of text."""
    corners = box(dem, east, north, half)[:-1]
    return "polygon " + " ".join(f"{lat:.7f} {lon:.7f}" for lon, lat in corners) + more


def geojson(path, dem, properties, geometry=None):
    """A file of one feature."""
    shape = geometry or {"type": "Polygon", "coordinates": [box(dem, 0, 0, 20)]}
    feature = {"type": "Feature", "properties": properties, "geometry": shape}
    path.write_text(json.dumps({"type": "FeatureCollection", "features": [feature]}))
    return f"fence.file={path}"


def test_a_file_gives_zones_with_heights(tmp_path, dem):
    """Polygons are kept out of, by name, their heights above sea level; the plan's frame has z."""
    given = geojson(tmp_path / "f.geojson", dem, {"name": "mast", "top_m": dem.origin.alt_m + 50})
    fence, _ = fence_of(scenario(given), dem)
    (zone,) = fence.keep_out
    assert (zone.name, zone.bottom_m) == ("mast", None)
    assert zone.top_m == pytest.approx(50.0)
    assert np.array(zone.outer) == pytest.approx(
        np.array([[-20, -20], [20, -20], [20, 20], [-20, 20]]), abs=0.01
    )


def test_heights_above_ground_count_from_its_highest_place(tmp_path, dem):
    """A top above ground stands on the highest ground of the zone, a bottom on the lowest."""
    given = geojson(tmp_path / "f.geojson", dem, {"bottom_m": 10, "top_m": 50})
    fence, _ = fence_of(scenario(given, "fence.heights=ground"), dem)
    (zone,) = fence.keep_out
    sides = np.meshgrid(np.linspace(-20, 20, 81), np.linspace(-20, 20, 81))
    ground = dem.height(*sides)
    assert zone.top_m == pytest.approx(ground.max() + 50, abs=0.5)
    assert zone.bottom_m == pytest.approx(ground.min() + 10, abs=0.5)


def test_a_fence_of_qgroundcontrol_is_read(tmp_path, dem):
    """Inclusions are kept in, exclusions kept out of."""
    ring = [[lat, lon] for lon, lat in box(dem, 0, 0, 300)[:-1]]
    document = {
        "fileType": "Plan",
        "version": 1,
        "mission": {"version": 2, "items": [], "plannedHomePosition": [0, 0, 0]},
        "geoFence": {
            "version": 2,
            "polygons": [{"version": 1, "inclusion": True, "polygon": ring}],
            "circles": [
                {"version": 1, "inclusion": False, "circle": {"center": ring[0], "radius": 9.0}}
            ],
        },
        "rallyPoints": {"version": 2, "points": []},
    }
    path = tmp_path / "fence.plan"
    path.write_text(json.dumps(document))
    fence, _ = fence_of(scenario(f"fence.file={path}"), dem)
    assert len(fence.keep_in) == 1
    assert fence.keep_out[0].radius_m == 9.0


@pytest.mark.parametrize(
    ("properties", "reason"),
    [
        ({"ceiling": 400}, "'ceiling', of which neither unit nor zero is known"),
        ({"kind": "avoid"}, "its kind is 'avoid', must be keep_out or keep_in"),
        ({"top_m": "high"}, "its top_m is 'high', must be a number"),
        ({"top_m": 5, "bottom_m": 6}, "bottom_m is not below top_m"),
        ({"kind": "keep_in", "top_m": 5}, "kept in has no heights"),
    ],
)
def test_what_is_ambiguous_in_a_file_is_refused(tmp_path, dem, properties, reason):
    """The message names key, file and feature, the reason and the cure."""
    given = geojson(tmp_path / "f.geojson", dem, properties)
    with pytest.raises(SiteError, match=reason) as caught:
        fence_of(scenario(given), dem)
    assert "fence.file" in str(caught.value)
    assert "f.geojson" in str(caught.value)


def test_a_point_needs_a_radius(tmp_path, dem):
    """A point is a circle where it has radius_m, else it is refused."""
    lon, lat = box(dem, 30, 40, 0)[0]
    point = {"type": "Point", "coordinates": [lon, lat]}
    given = geojson(tmp_path / "f.geojson", dem, {"radius_m": 12.5}, point)
    (zone,) = fence_of(scenario(given), dem)[0].keep_out
    assert (zone.radius_m, *zone.centre_m) == pytest.approx((12.5, 30, 40), abs=0.01)
    given = geojson(tmp_path / "f.geojson", dem, {}, point)
    with pytest.raises(SiteError, match="is a point without radius_m"):
        fence_of(scenario(given), dem)


def test_crossing_outlines_are_refused(dem):
    """A ring that crosses itself is told with its key."""
    text = "polygon 36.6 -84.2 36.7 -84.1 36.6 -84.1 36.7 -84.2"
    with pytest.raises(SiteError, match=r"fence.keep_out\[0\]: its outline crosses itself"):
        fence_of(scenario(f'fence.keep_out=["{text}"]'), dem)


def test_a_plan_goes_round_and_says_so(tmp_path, dem):
    """A zone about a waypoint of tiny.yaml: it is left out, rules are kept, files keep both."""
    before = survey(scenario())
    east, north, _ = before.waypoints[1].position_m
    loaded = scenario(f'fence.keep_out=["{zone_text(dem, east, north, 25, " name pond")}"]')
    found = survey(loaded)
    assert found.fence is not None
    assert set(found.waypoints) < set(before.waypoints)
    planned = plan_routes(loaded.scenario, found)
    kinds = {one.kind for one in planned.certificate.violations}
    assert not kinds & {"keep_out", "keep_in", "route", "visit"}
    write_plan(planned.plan, tmp_path / "plan.json")
    assert read_plan(tmp_path / "plan.json").fence == planned.plan.fence
    text = write_scenario(loaded, tmp_path / "scenario.yaml")
    assert "name pond" in text
    assert load_scenario(tmp_path / "scenario.yaml").scenario.fence == loaded.scenario.fence


def test_what_cannot_be_is_infeasible_by_name(dem):
    """A zone over all of it, and one over the pads, end before the search with their names."""
    everything = scenario(f'fence.keep_out=["{zone_text(dem, 0, 0, 900, " name city")}"]')
    with pytest.raises(InfeasibleError, match=r"All .* waypoints lie in no-fly zones .* city"):
        survey(everything)
    place = survey(scenario()).waypoints[0].position_m
    pads = f"starts.positions_m=[{place[0]:.0f},{place[1]:.0f}]"
    low = zone_text(dem, place[0], place[1], 30, " top 0 name hut")
    loaded = scenario(pads, f'fence.keep_out=["{low}"]', "fence.heights=ground")
    with pytest.raises(InfeasibleError, match=r"Pads lie in no-fly zones.*in hut"):
        plan_routes(loaded.scenario, survey(loaded))


def test_waypoints_of_a_file_in_a_zone_are_refused(tmp_path, dem):
    """Somebody wants these waypoints: they are named, not dropped."""
    path = tmp_path / "w.csv"
    lat, lon, _ = dem.to_geodetic(np.array([[0.0, 0, 0], [80.0, 0, 0]]))
    rows = "".join(f"{a:.7f},{b:.7f},60\n" for a, b in zip(lat, lon, strict=True))
    path.write_text("lat,lon,agl_m\n" + rows)
    zone = f'fence.keep_out=["{zone_text(dem, 0, 0, 20, " name pond")}"]'
    with pytest.raises(JftoError) as caught:
        survey(scenario("waypoints.source=file", f"waypoints.file={path}", zone))
    assert isinstance(caught.value, WaypointError)
    assert "in pond must not be flown to" in str(caught.value)


@pytest.mark.parametrize("key", ["keep_out", "keep_in"])
def test_a_shape_far_from_the_terrain_is_refused(dem, key):
    """Exchanged latitude and longitude are recognised; any other place is named with its distance.

    One that lies around the terrain is near, however far its corners are.
    """
    lat, lon = dem.origin.lat_deg, dem.origin.lon_deg
    with pytest.raises(SiteError, match=rf"fence.{key}\[0\]: its latitude and longitude are exch"):
        fence_of(scenario(f"fence.{key}=circle {lon} {lat} 60 m"), dem)
    with pytest.raises(SiteError, match=rf"fence.{key}\[0\]: it lies at 46.0000, 7.0000, \d+ km"):
        fence_of(scenario(f"fence.{key}=circle 46 7 60 m"), dem)
    around = f"polygon {lat - 3} {lon - 3} {lat - 3} {lon + 3} {lat + 3} {lon}"
    fence, _ = fence_of(scenario(f"fence.{key}={around}"), dem)
    assert fence is not None
