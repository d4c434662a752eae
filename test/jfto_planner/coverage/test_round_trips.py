"""Whatever is written into files of other programs comes back as it was."""

from __future__ import annotations

import zipfile
from pathlib import Path
from xml.etree import ElementTree as ET

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from jfto_msgs_py.errors import WaypointError
from jfto_msgs_py.mission_file import (
    FORMATS,
    GeoArea,
    GeoPlan,
    GeoRoute,
    GeoStop,
    MissionTextError,
)
from jfto_planner.coverage import Assumed, read_waypoint_set
from jfto_world.terrain import load_dem

CASES = Path(__file__).parents[2] / "data/cases"
HOME = (46.2, 7.6, 1500.0)
WRITTEN = [form for form in FORMATS if form.write is not None]
SQUARE = ((46.199, 7.599), (46.201, 7.599), (46.201, 7.601), (46.199, 7.601))


@pytest.fixture(scope="module")
def dem():
    """Sloping ground, 1500 m in the middle."""
    return load_dem(CASES / "00-ground.tif", center=(46.2, 7.6), size_m=(400.0, 400.0))


def stops(seed, count, photos):
    """Places some metres apart, well above the slope, with any view."""
    rng = np.random.default_rng(seed)
    lat = 46.2 + rng.uniform(-0.0015, 0.0015, count)
    lon = 7.6 + rng.uniform(-0.002, 0.002, count)
    yaw, pitch = rng.uniform(0, 360, count), rng.uniform(-90, 30, count)
    high = rng.uniform(1650, 1800, count)
    return tuple(
        GeoStop(7 * k, (float(lat[k]), float(lon[k]), float(high[k])), float(yaw[k]),
                float(pitch[k]), photo=bool(photos[k]), above_ground_m=80.0, arrival_s=3.0 * k)
        for k in range(count)
    )  # fmt: skip


def same(waypoint, stop, dem):
    """Within 2 cm and 1e-7 degrees, heading and pitch as they were."""
    assert np.allclose(waypoint.position_m, dem.to_enu(*stop.at), atol=0.02)
    lat, lon, _ = dem.to_geodetic(waypoint.position_m)
    assert abs(float(lat) - stop.at[0]) <= 1e-7
    assert abs(float(lon) - stop.at[1]) <= 1e-7
    assert abs((waypoint.yaw_deg - stop.yaw_deg + 180) % 360 - 180) <= 1e-5
    assert waypoint.pitch_deg == pytest.approx(stop.pitch_deg, abs=1e-5)


@pytest.mark.parametrize("form", WRITTEN, ids=lambda form: form.key)
@settings(deadline=None, derandomize=True, max_examples=25)
@given(
    st.integers(0, 2**32 - 1),
    st.lists(st.booleans(), min_size=1, max_size=12).filter(any),
    st.text(min_size=1, max_size=12),
)
def test_what_is_written_comes_back(tmp_path_factory, dem, form, seed, photos, name):
    """Places, views and order of a route's photos, in every format that is written.

    Whatever the vehicle is called, and without the places that are only passed.
    """
    route = GeoRoute(name, stops(seed, len(photos), photos), HOME, (HOME,), 6.5)
    areas = (GeoArea("ß & <b>", SQUARE, (SQUARE[:3],), 1500.0, None),)
    plan = GeoPlan(name, (route,), areas, areas, areas)
    path = tmp_path_factory.mktemp("written") / f"Ünï 1{form.suffixes[0].upper()}"
    path.write_bytes(form.write(plan))
    found = read_waypoint_set(path, dem, Assumed(HOME[:2]))
    expected = [stop for stop in route.stops if stop.photo]
    assert len(found.waypoints) == len(expected)
    for waypoint, stop in zip(found.waypoints, expected, strict=True):
        same(waypoint, stop, dem)


@pytest.mark.parametrize("form", [f for f in WRITTEN if not f.per_uav], ids=lambda form: form.key)
def test_two_routes_come_back_one_after_the_other(tmp_path, dem, form):
    """In the order of the fleet; bytes are the same for the same plan."""
    routes = tuple(GeoRoute(f"uav{k}", stops(k, 5, [1] * 5), HOME) for k in (1, 2))
    plan = GeoPlan("both", routes)
    path = tmp_path / f"both{form.suffixes[0]}"
    path.write_bytes(form.write(plan))
    assert form.write(plan) == path.read_bytes()
    found = read_waypoint_set(path, dem).waypoints
    for waypoint, stop in zip(found, (*routes[0].stops, *routes[1].stops), strict=True):
        same(waypoint, stop, dem)


# Order of children as http://schemas.opengis.net/kml/2.2.0/ogckml22.xsd has them.
ORDER = {
    "Document": ["name", "Style", "Folder"],
    "Folder": ["name", "Placemark"],
    "Style": ["IconStyle", "LineStyle", "PolyStyle"],
    "LineStyle": ["color", "width"],
    "Placemark": ["name", "Camera", "styleUrl", "ExtendedData", "Point", "LineString", "Polygon"],
    "Camera": ["longitude", "latitude", "altitude", "heading", "tilt", "roll", "altitudeMode"],
    "Point": ["extrude", "altitudeMode", "coordinates"],
    "LineString": ["extrude", "tessellate", "altitudeMode", "coordinates"],
    "Polygon": ["extrude", "tessellate", "altitudeMode", "outerBoundaryIs", "innerBoundaryIs"],
}


def test_elements_of_a_kml_stand_in_the_order_of_its_schema():
    """OGC's schema is a sequence: Google Earth forgives, others do not."""
    areas = (GeoArea("a", SQUARE, (SQUARE[:3],), None, 1600.0),)
    plan = GeoPlan("p", (GeoRoute("u", stops(1, 3, [1, 0, 1]), HOME, (HOME,)),), *[areas] * 3)
    root = ET.fromstring(next(f for f in FORMATS if f.key == "kml").write(plan))
    space = "{http://www.opengis.net/kml/2.2}"
    assert root.tag == f"{space}kml"
    met = set()
    for parent in root.iter():
        order = ORDER.get(parent.tag.removeprefix(space))
        if order is not None:
            places = [order.index(one.tag.removeprefix(space)) for one in parent]
            assert places == sorted(places), parent.tag
            met.add(parent.tag.removeprefix(space))
    assert met == set(ORDER)
    styles = {f"#{one.get('id')}" for one in root.iter(f"{space}Style")}
    assert {one.text for one in root.iter(f"{space}styleUrl")} <= styles


def test_a_wayline_has_what_djis_format_wants(tmp_path):
    """Both members, the drone's numbers, one group of actions per waypoint, photos where wanted."""
    form = next(f for f in FORMATS if f.key == "wpml" and f.write)
    plan = GeoPlan("p", (GeoRoute("u", stops(1, 3, [1, 0, 1]), HOME),), drone="M30T")
    path = tmp_path / "w.kmz"
    path.write_bytes(form.write(plan))
    with zipfile.ZipFile(path) as archive:
        assert archive.namelist() == ["wpmz/template.kml", "wpmz/waylines.wpml"]
        template, waylines = (ET.fromstring(archive.read(name)) for name in archive.namelist())
    space = "{http://www.dji.com/wpmz/1.0.2}"

    def told(root, name):
        return [one.text for one in root.iter(f"{space}{name}")]

    for root in (template, waylines):
        assert (told(root, "droneEnumValue"), told(root, "droneSubEnumValue")) == (["67"], ["1"])
        assert told(root, "payloadEnumValue") == ["53"]
        assert told(root, "index") == ["0", "1", "2"]
        assert told(root, "actionActuatorFunc").count("takePhoto") == 2
        assert told(root, "actionGroupStartIndex") == told(root, "actionGroupEndIndex")
    assert told(waylines, "executeHeightMode") == ["relativeToStartPoint"]
    heights = [float(text) for text in told(waylines, "executeHeight")]
    assert heights == pytest.approx([s.at[2] - 1500 for s in plan.routes[0].stops], abs=1e-3)
    assert told(template, "heightMode") == ["relativeToStartPoint"]


@pytest.mark.parametrize("key", ["wpml", "litchi"])
def test_waypoints_without_a_pad_have_no_height_above_one(key):
    """Formats whose heights are above take-off refuse them, and name those that do not."""
    form = next(f for f in FORMATS if f.key == key and f.write)
    with pytest.raises(MissionTextError, match="as CSV or KML"):
        form.write(GeoPlan("w", (GeoRoute("", stops(1, 2, [1, 1])),)))


def test_litchis_heights_need_a_home(tmp_path, dem):
    """Its table does not name the place of take-off."""
    form = next(f for f in FORMATS if f.key == "litchi")
    path = tmp_path / "l.csv"
    path.write_bytes(form.write(GeoPlan("l", (GeoRoute("u", stops(1, 2, [1, 1]), HOME),))))
    with pytest.raises(WaypointError, match=r"Litchi names no home; set waypoints\.home_deg"):
        read_waypoint_set(path, dem)
