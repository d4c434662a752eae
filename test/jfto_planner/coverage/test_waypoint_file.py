import json

import numpy as np
import pytest
import rasterio
from affine import Affine
from hypothesis import given, settings
from hypothesis import strategies as st

from jfto_msgs_py.errors import WaypointError
from jfto_planner.coverage import read_waypoints
from jfto_world.terrain import load_dem

LAT, LON = 36.6301, -84.2626


@pytest.fixture(scope="module")
def dem():
    return load_dem("jacksboro", center=(LAT, LON), size_m=(1000, 1000))


def write(tmp_path, name, content):
    path = tmp_path / name
    if isinstance(content, bytes):
        path.write_bytes(content)
    else:
        path.write_text(content if isinstance(content, str) else json.dumps(content))
    return path


def point(lon, lat, *alt, **properties):
    geometry = {"type": "Point", "coordinates": [lon, lat, *alt]}
    return {"type": "Feature", "properties": properties, "geometry": geometry}


def plan(*items, home=(LAT, LON, 660.0), file_type="Plan"):
    mission = {"version": 2, "items": list(items), "plannedHomePosition": list(home)}
    return {"fileType": file_type, "version": 1, "mission": mission}


def item(lat=LAT, lon=LON, alt=900.0, *, command=16, frame=0, yaw=None, first=0):
    params = [first, 0, 0, yaw, lat, lon, alt]
    return {"type": "SimpleItem", "command": command, "frame": frame, "params": params}


def test_csv_in_local_metres(tmp_path, dem):
    """x_m, y_m, z_m are taken as they are; order gives ids; angles and comments are optional."""
    text = "X_m, y_m ,z_m,yaw_deg,pitch_deg,remark\n0,0,50,-90,-45,first\n\n10.5,-20,60,,,second\n"
    first, second = read_waypoints(write(tmp_path, "w.csv", text), dem)
    assert (first.id, first.position_m, first.yaw_deg, first.pitch_deg) == (0, (0, 0, 50), 270, -45)
    assert (second.id, second.position_m) == (1, (10.5, -20, 60))
    assert (second.yaw_deg, second.pitch_deg) == (0, -90)


def test_csv_on_the_globe_and_above_ground(tmp_path, dem):
    """lat, lon, alt use the DEM's datum; agl_m counts from the ground below."""
    text = f"lat,lon,alt\n{LAT},{LON},{dem.origin.alt_m + 80}\n"
    (above_origin,) = read_waypoints(write(tmp_path, "a.csv", text), dem)
    assert above_origin.position_m == pytest.approx((0, 0, 80), abs=1e-6)
    (low,) = read_waypoints(write(tmp_path, "b.csv", "x_m,y_m,agl_m\n200,-100,35\n"), dem)
    assert low.position_m[2] == pytest.approx(float(dem.height(200, -100)) + 35)
    text = f"lat,lon,agl_m\n{LAT + 0.001},{LON},35\n"
    (north,) = read_waypoints(write(tmp_path, "c.csv", text), dem)
    x, y, z = north.position_m
    assert z - float(dem.height(x, y)) == pytest.approx(35, abs=1e-6)
    assert y == pytest.approx(111, abs=1)


@settings(deadline=None, derandomize=True, max_examples=20)
@given(st.integers(0, 2**32 - 1), st.integers(1, 12))
def test_one_set_in_three_formats(tmp_path_factory, dem, seed, count):
    """CSV, GeoJSON and .plan of the same places give the same waypoints, to a millimetre."""
    rng = np.random.default_rng(seed)
    place = np.column_stack([rng.uniform(-500, 500, (count, 2)), np.zeros(count)])
    place[:, 2] = dem.height(place[:, 0], place[:, 1]) + rng.uniform(5, 200, count)
    yaw = rng.uniform(0, 360, count).round(3)
    lat, lon, alt = (a.tolist() for a in dem.to_geodetic(place))
    rows = [f"{a!r},{b!r},{c!r},{d}" for a, b, c, d in zip(lat, lon, alt, yaw, strict=True)]
    folder = tmp_path_factory.mktemp("formats")
    features = [
        point(b, a, c, yaw_deg=d) for a, b, c, d in zip(lat, lon, alt, yaw.tolist(), strict=True)
    ]
    items = [item(a, b, c, yaw=d) for a, b, c, d in zip(lat, lon, alt, yaw.tolist(), strict=True)]
    files = {
        "w.csv": "lat,lon,alt,yaw_deg\n" + "\n".join(rows),
        "w.geojson": {"type": "FeatureCollection", "features": features},
        "w.plan": plan(*items),
    }
    for name, content in files.items():
        found = read_waypoints(write(folder, name, content), dem)
        assert [w.id for w in found] == list(range(count))
        assert np.array([w.position_m for w in found]) == pytest.approx(place, abs=1e-3)
        assert [w.yaw_deg for w in found] == pytest.approx(yaw.tolist())


def test_geojson_geometries(tmp_path, dem):
    """A bare Point, a MultiPoint and agl_m in the properties are read."""
    high = dem.origin.alt_m + 200
    (bare,) = read_waypoints(
        write(tmp_path, "p.json", {"type": "Point", "coordinates": [LON, LAT, high]}), dem
    )
    assert bare.position_m[2] == pytest.approx(200, abs=1e-6)
    many = {"type": "MultiPoint", "coordinates": [[LON, LAT, high], [LON, LAT + 0.001, high]]}
    assert len(read_waypoints(write(tmp_path, "m.geojson", many), dem)) == 2
    (low,) = read_waypoints(write(tmp_path, "f.geojson", point(LON, LAT, agl_m=30)), dem)
    assert low.position_m[2] == pytest.approx(30, abs=0.01)


def test_qgc_plan_frames_gimbal_and_surveys(tmp_path, dem):
    """AMSL, relative and terrain altitudes; gimbal pitch; a survey's items; take-off skipped."""
    survey = {
        "type": "ComplexItem",
        "complexItemType": "survey",
        "TransectStyleComplexItem": {"Items": [item(LAT + 0.002, alt=70.0, frame=10)]},
    }
    content = plan(
        item(command=22, frame=3, alt=20.0),
        item(alt=dem.origin.alt_m + 100),
        item(command=205, first=-30),
        item(LAT + 0.001, alt=dem.origin.alt_m + 50 - 660.0 + 150, frame=3, yaw=45),
        item(command=206),
        survey,
        item(command=20, lat=0, lon=0, alt=0),
    )
    first, second, third = read_waypoints(write(tmp_path, "m.plan", content), dem)
    assert first.position_m == pytest.approx((0, 0, 100), abs=1e-6)
    assert (first.pitch_deg, second.pitch_deg, second.yaw_deg) == (-90, -30, 45)
    assert second.position_m[2] == pytest.approx(200, abs=0.01)
    x, y, z = third.position_m
    assert z - float(dem.height(x, y)) == pytest.approx(70, abs=1e-6)


GOOD = "x_m,y_m,z_m\n0,0,50\n"
BAD = {
    "no file": ("none.csv", None, "no such file"),
    "suffix": ("w.xls", "places", "no known waypoint format"),
    "empty": ("w.csv", " \n", "empty"),
    "binary": ("w.csv", b"\xff\xfe\x00\x01", "UTF-8"),
    "header only": ("w.csv", "x_m,y_m,z_m\n", "no waypoint"),
    "no header": ("w.csv", "0,0,50\n1,1,50\n", "line 1: the header"),
    "mixed separators": ("w.csv", "x_m;y_m;z_m\n0,0,50\n", "or separate with semicolons"),
    "no height": ("w.csv", "x_m,y_m\n0,0\n", "no column of height"),
    "two heights": ("w.csv", "x_m,y_m,z_m,agl_m\n0,0,1,1\n", "two columns of height"),
    "two places": ("w.csv", "x_m,y_m,lat,lon,alt\n0,0,1,1,1\n", "line 1: the header"),
    "doubled column": ("w.csv", "x_m,y_m,z_m,z_m\n0,0,1,1\n", "z_m appears twice"),
    "missing value": ("w.csv", GOOD + "1,2\n", "line 3: has 2 values"),
    "word": ("w.csv", GOOD + "1,two,50\n", "line 3: y_m is 'two'"),
    "nan": ("w.csv", GOOD + "1,nan,50\n", "line 3: y_m is 'nan'"),
    "infinite": ("w.csv", GOOD + "1,1,inf\n", "line 3: z_m is 'inf'"),
    "open quote": ("w.csv", 'x_m,y_m,z_m\n"0,0,50\n', "is not CSV"),
    "duplicate": ("w.csv", GOOD + "5,5,50\n0,0,50.001\n", "line 4: is the same place as"),
    "outside": ("w.csv", GOOD + "5000,0,50\n", "line 3: lies 5000 m east"),
    "buried": ("w.csv", GOOD + "0,1,-50\n", "line 3: lies"),
    "pitch": ("w.csv", "x_m,y_m,z_m,pitch_deg\n0,0,50,-91\n", "pitch_deg is -91"),
    "lat and lon exchanged": ("w.csv", f"lat,lon,alt\n{LON},{LAT},900\n", "outside"),
    "latitude": ("w.csv", "lat,lon,alt\n95,10,900\n", "not a latitude"),
    "elsewhere": ("w.csv", "lat,lon,agl_m\n47,8,50\n", "lies outside the terrain"),
    "not json": ("w.geojson", '{"type": "FeatureCollection",', "line 1, column"),
    "json list": ("w.geojson", [1, 2], "not a GeoJSON object"),
    "line string": (
        "w.geojson",
        {"type": "LineString", "coordinates": [[LON, LAT, 900], [LON, LAT, 950]]},
        "'LineString'",
    ),
    "no features": ("w.geojson", {"type": "FeatureCollection"}, "features is missing"),
    "no geometry": ("w.geojson", {"type": "Feature", "geometry": None}, "no geometry"),
    "no altitude": ("w.geojson", point(LON, LAT), "no altitude"),
    "text altitude": ("w.geojson", point(LON, LAT, "high"), "altitude is 'high'"),
    "boolean": ("w.geojson", point(LON, True, 900), "latitude is True"),
    "second feature": (
        "w.geojson",
        {"type": "FeatureCollection", "features": [point(LON, LAT, 900), 7]},
        "feature 1",
    ),
    "plan of another type": ("w.plan", plan(item(), file_type="GeoFence"), "not a QGroundControl"),
    "plan without mission": ("w.plan", {"fileType": "Plan"}, "not a QGroundControl"),
    "plan without items": ("w.plan", {"fileType": "Plan", "mission": {}}, "items is missing"),
    "plan with nothing to see": ("w.plan", plan(item(command=22)), "no waypoint"),
    "loiter": ("w.plan", plan(item(), item(command=18)), "item 2: command 18"),
    "frame": ("w.plan", plan(item(frame=1)), "altitude frame 1"),
    "no home": ("w.plan", plan(item(frame=3), home=()), "plannedHomePosition"),
    "short params": (
        "w.plan",
        plan({"type": "SimpleItem", "command": 16, "frame": 0, "params": [0]}),
        "item 1: params",
    ),
    "structure": (
        "w.plan",
        plan({"type": "ComplexItem", "complexItemType": "StructureScan"}),
        "'StructureScan'",
    ),
    "null latitude": ("w.plan", plan(item(lat=None)), "the latitude of command 16 is left open"),
}


@pytest.mark.parametrize("case", BAD, ids=str)
def test_bad_files_are_refused_with_place_reason_and_cure(tmp_path, dem, case):
    """Each bad file gives a WaypointError that names file, line or item, and reason."""
    name, content, reason = BAD[case]
    path = tmp_path / name if content is None else write(tmp_path, name, content)
    with pytest.raises(WaypointError) as caught:
        read_waypoints(path, dem)
    assert str(path) in str(caught.value)
    assert reason in str(caught.value)
    assert str(caught.value).rstrip().endswith((".", ")."))


def test_sea_level_and_ellipsoid_are_never_mixed(tmp_path):
    """Altitudes above sea level mean the same over heights above the ellipsoid and above the sea.

    At Zurich the geoid lies 47.5 m above the ellipsoid: an altitude of 500 m is 100 m above a
    ground that is 447.5 m above the ellipsoid.
    """
    lat, lon, heights = 47.375, 8.55, np.full((80, 80), 447.5, dtype=np.float32)
    options = {"driver": "GTiff", "count": 1, "dtype": "float32", "height": 80, "width": 80}
    options["transform"] = Affine(1 / 3600, 0, lon - 40 / 3600, 0, -1 / 3600, lat + 40 / 3600)
    path = tmp_path / "ellipsoidal.tif"
    with rasterio.open(path, "w", crs="EPSG:4979", **options) as file:
        file.write(heights, 1)
    dem = load_dem(path, center=(lat, lon), size_m=(300, 300))
    (found,) = read_waypoints(write(tmp_path, "w.plan", plan(item(lat, lon, 500.0))), dem)
    assert found.position_m[2] == pytest.approx(100.0, abs=1.0)
    assert "brought to sea level by the geoid EGM96" in " ".join(dem.notes)
    text = f"lat,lon,ellipsoid_m\n{lat},{lon},547.5\n"
    (same,) = read_waypoints(write(tmp_path, "w.csv", text), dem)
    assert same.position_m[2] == pytest.approx(100.0, abs=1e-3)
