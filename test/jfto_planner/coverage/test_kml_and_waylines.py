"""Waypoints of KML and of DJI's waylines."""

from __future__ import annotations

import pytest

from jfto_msgs_py.errors import WaypointError
from jfto_planner.coverage import (
    Assumed,
    Camera,
    certify_coverage,
    read_waypoint_set,
    read_waypoints,
)
from jfto_world.terrain import load_dem
from support.foreign_files import (
    CASES,
    EAST,
    KML,
    LAT,
    LON,
    NORTH,
    TAKE_OFF,
    action,
    djis,
    group,
    kmz,
    leg,
    litchi,
    mark,
    stop,
    tag,
    wayline,
    write,
)


@pytest.fixture(scope="module")
def dem():
    """Sloping ground, 1500 m in the middle."""
    return load_dem(CASES / "00-ground.tif", center=(LAT, LON), size_m=(400.0, 400.0))


def test_points_of_a_kml_by_altitude_mode(tmp_path, dem):
    """Absolute is above sea level, relativeToGround above ground; clamped ones get a height."""
    path = write(
        tmp_path,
        "w.kml",
        KML.format(
            mark(0, 1580)
            + mark(20, 70, "relativeToGround")
            + mark(40, 9999, "")
            + mark(60, 0, "clampToGround")
        ),
    )
    found = read_waypoint_set(path, dem, Assumed(clamped_m=55))
    above = [w.position_m[2] - float(dem.height(*w.position_m[:2])) for w in found.waypoints]
    assert above == pytest.approx([80, 70, 55, 55], abs=0.02)
    assert "2 points lie on the ground" in found.notes[0]
    with pytest.raises(WaypointError, match=r"placemark 3 \(w\): lies on the ground"):
        read_waypoints(path, dem)


def test_what_a_placemark_carries_beside(tmp_path, dem):
    """Heading and pitch as data or as a camera; take_photo false; the rest is said."""
    values = {"Heading": 30, "gimbal_pitch": -60, "who": "é"}
    told = [tag(f'Data name="{key}"', tag("value", value)) for key, value in values.items()]
    data = tag("ExtendedData", *told)
    camera = "<Camera><heading>120</heading><tilt>25</tilt></Camera>"
    simple = tag('SimpleData name="yaw"', 7)
    schema = tag("ExtendedData", tag("SchemaData", simple))
    off = tag("ExtendedData", tag('Data name="take_photo"', tag("value", "false")))
    area = "<Placemark><Polygon><outerBoundaryIs/></Polygon></Placemark>"
    text = KML.format(
        f"<Folder>{mark(0, 1580, extra=data)}{mark(9, 1580, extra=camera)}</Folder>{area}"
        f"{mark(18, 1580, extra=schema)}{mark(27, 1580, extra=off)}"
    )
    found = read_waypoint_set(kmz(tmp_path, files__doc_dot_kml=text), dem)
    assert [(w.yaw_deg, w.pitch_deg) for w in found.waypoints] == [(30, -60), (120, -65), (7, -90)]
    told = " ".join(found.notes)
    assert "not used: who" in told
    assert "Polygon × 1" in told
    assert "1 points without a photo" in told


@pytest.mark.parametrize("kind", ["line", "track"])
def test_corners_of_lines_are_waypoints_where_there_are_no_points(tmp_path, dem, kind):
    """In their order, of a LineString or a gx:Track; beside points lines are not used."""
    if kind == "line":
        corners = "\n\t".join(f"{LON},{LAT + 9 * k * NORTH},80" for k in range(3))
        mode = tag("altitudeMode", "relativeToGround")
        line = tag("LineString", mode, tag("coordinates", corners))
    else:
        corners = "".join(
            f"<gx:coord>{LON} {LAT + 9 * k * NORTH} 1590</gx:coord>" for k in range(3)
        )
        line = f"<gx:Track><altitudeMode>absolute</altitudeMode>{corners}</gx:Track>"
    text = f"<Placemark><MultiGeometry>{line}</MultiGeometry></Placemark>"
    found = read_waypoints(write(tmp_path, "w.kml", KML.format(text)), dem)
    assert [w.position_m[1] for w in found] == pytest.approx([0, 9, 18], abs=0.05)
    both = read_waypoint_set(write(tmp_path, "b.kml", KML.format(text + mark(5, 1590))), dem)
    assert len(both.waypoints) == 1
    assert "× 1" in both.notes[-1]


def test_waylines_are_flown_photo_by_photo(tmp_path, dem):
    """Two waylines; heading, gimbal and shutter as actions; a way point without photo is none."""
    tilt = action("gimbalRotate", gimbalRotateMode="absoluteAngle", gimbalPitchRotateAngle=-60)
    turn = action("rotateYaw", aircraftHeading=-90)
    photo = action("takePhoto", payloadPositionIndex=0)
    path = djis(
        tmp_path,
        wayline(
            stop(1, 20, 90, group(turn, photo), angle=10),
            stop(0, 0, 80, group(tilt, photo, action("zoom", focalLength=24)), angle=45),
            stop(2, 40, 90),
        ),
        wayline(
            stop(0, 60, 100, group(photo), mode="towardPOI", poi=f"{LAT},{LON},0"),
            mode="aboveGroundLevel",
        ),
        config=TAKE_OFF,
    )
    found = read_waypoint_set(path, dem)
    assert [(round(w.yaw_deg, 3), w.pitch_deg) for w in found.waypoints] == [
        (45, -60),
        (270, -60),
        (180, -60),
    ]
    assert [w.position_m[2] for w in found.waypoints[:2]] == pytest.approx([80, 90], abs=0.05)
    x, y, z = found.waypoints[2].position_m
    assert z - float(dem.height(x, y)) == pytest.approx(100, abs=0.01)
    told = " ".join(found.notes)
    assert "not used: zoom × 1" in told
    assert "count from the ground at 46.20000, 7.60000, 1500.0 m" in told


def test_a_wayline_above_the_ellipsoid(tmp_path, dem):
    """WGS84 heights come down by the geoid, 52 m in the Alps, and that is said."""
    path = djis(tmp_path, wayline(stop(0, 0, 1632), mode="WGS84"))
    found = read_waypoint_set(path, dem)
    assert found.waypoints[0].position_m[2] == pytest.approx(80, abs=1.5)
    assert "above the ellipsoid are brought to sea level" in found.notes[0]


def test_a_closed_line_has_one_waypoint_where_it_closes(tmp_path, dem):
    """The corner at which it ends is its first, and that is said."""
    ring = " ".join(
        f"{LON + x * EAST},{LAT + y * NORTH},1600" for x, y in ((0, 0), (9, 0), (9, 9), (0, 0))
    )
    line = tag("LineString", tag("altitudeMode", "absolute"), tag("coordinates", ring))
    path = write(tmp_path, "w.kml", KML.format(tag("Placemark", line)))
    found = read_waypoint_set(path, dem)
    assert len(found.waypoints) == 3
    assert "1 corners at a place met before" in found.notes[0]


def test_waylines_without_photos_are_looked_at_from(tmp_path, dem):
    """All waypoints, as turned on reaching them; followWayline looks along the way."""
    tilt = action("gimbalRotate", gimbalPitchRotateAngle=-30)
    stops = [stop(k, 20 * k, 80, group(tilt), mode="followWayline") for k in range(3)]
    path = djis(tmp_path, wayline(*stops), config=TAKE_OFF)
    assert [(round(w.yaw_deg), w.pitch_deg) for w in read_waypoints(path, dem)] == [(0, -30)] * 3


@pytest.mark.parametrize(("trigger", "every"), [("multipleDistance", 10), ("multipleTiming", 2)])
def test_a_trigger_of_a_wayline_lays_photos_along_it(tmp_path, dem, trigger, every):
    """Every 10 m, or every 2 s at 5 m/s, from waypoint 1 to waypoint 2 and no further."""
    often = group(action("takePhoto"), trigger=trigger, every=every, start=1, end=2)
    stops = [stop(0, 0, 80, often), *(stop(k, 40 * k, 80) for k in (1, 2, 3))]
    found = read_waypoints(djis(tmp_path, wayline(*stops), config=TAKE_OFF), dem)
    first = 40 if trigger == "multipleDistance" else 50
    assert [w.position_m[1] for w in found] == pytest.approx(range(first, 81, 10), abs=0.1)


def test_waypoints_of_any_origin_are_certified_alike(tmp_path, dem):
    """The share seen of the same photos in a table, KML, a wayline and Litchi's table."""
    photo = action("takePhoto")
    norths = [20 * k - 190 for k in range(20)]
    stops = [stop(k, n, 80, group(photo), mode="followWayline") for k, n in enumerate(norths)]
    table = "lat,lon,agl_m\n" + "".join(f"{LAT + n * NORTH},{LON},80\n" for n in norths)
    marks = "".join(mark(n, 80, "relativeToGround") for n in norths)
    rows = [leg(n, mode=1, actions=(1, 0, -1, 0)) for n in norths]
    paths = [
        djis(tmp_path, wayline(*stops, mode="aboveGroundLevel")),
        write(tmp_path, "w.csv", table),
        write(tmp_path, "w.kml", KML.format(marks)),
        write(tmp_path, "l.csv", litchi(*rows)),
    ]
    camera = Camera(17.3, 13.0, 15.0, 5280, 3956)
    seen = [certify_coverage(read_waypoints(p, dem), dem, camera).seen_once for p in paths]
    assert 0.1 < seen[0] < 0.5
    assert seen == pytest.approx([seen[0]] * 4, abs=0.01)
