"""Waypoints of tables, KML, DJI's waylines and Litchi."""

from __future__ import annotations

import math
import zipfile
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from jfto_msgs_py.errors import WaypointError
from jfto_planner.coverage import (
    Assumed,
    Camera,
    certify_coverage,
    read_waypoint_set,
    read_waypoints,
)
from jfto_world.terrain import load_dem
from jfto_world.terrain.geoid import geoid_height

CASES = Path(__file__).parents[2] / "data/cases"
LAT, LON, GROUND = 46.2, 7.6, 1500.0
NORTH = 1 / 111_150.0
EAST = NORTH / math.cos(math.radians(LAT))
XML = '<?xml version="1.0" encoding="UTF-8"?>\n'
KML_SPACE = 'xmlns="http://www.opengis.net/kml/2.2" xmlns:gx="http://www.google.com/kml/ext/2.2"'
DJI_SPACE = 'xmlns="http://www.opengis.net/kml/2.2" xmlns:wpml="http://www.dji.com/wpmz/1.0.6"'


def tag(name, *content):
    return f"<{name}>{''.join(map(str, content))}</{name.split()[0]}>"


def dji(name, *content):
    return tag(f"wpml:{name}", *content)


KML = XML + tag(f"kml {KML_SPACE}", tag("Document", "{}"))
WPML = XML + tag(f"kml {DJI_SPACE}", tag("Document", "<wpml:missionConfig/>{}"))
LITCHI = (
    "latitude,longitude,altitude(m),heading(deg),curvesize(m),rotationdir,gimbalmode,"
    "gimbalpitchangle,actiontype1,actionparam1,actiontype2,actionparam2,altitudemode,speed(m/s),"
    "poi_latitude,poi_longitude,poi_altitude(m),poi_altitudemode,photo_timeinterval,"
    "photo_distinterval\n"
)


@pytest.fixture(scope="module")
def dem():
    """Sloping ground, 1500 m in the middle."""
    return load_dem(CASES / "00-ground.tif", center=(LAT, LON), size_m=(400.0, 400.0))


def write(tmp_path, name, text):
    path = tmp_path / name
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return path


def kmz(tmp_path, **members):
    path = tmp_path / "w.KMZ"
    with zipfile.ZipFile(path, "w") as archive:
        for name, text in members.items():
            archive.writestr(name.replace("__", "/").replace("_dot_", "."), text)
    return path


def mark(north_m, height, mode="absolute", extra="", name="w", east_m=0.0):
    return (
        f"<Placemark><name>{name}</name>{extra}<Point>"
        + (f"<altitudeMode>{mode}</altitudeMode>" if mode else "")
        + f"<coordinates> {LON + east_m * EAST},{LAT + north_m * NORTH},{height} </coordinates>"
        "</Point></Placemark>"
    )


def test_a_height_is_above_what_its_column_says(tmp_path, dem):
    """Sea level, ground, home or the terrain's datum, in metres or feet; all are one place."""
    for column, value, home in (
        ("amsl_m", 1580, None),
        ("Altitude (m)", 1580, None),
        ("agl_m", 80, None),
        ("AGL_ft", 80 / 0.3048, None),
        ("above_home_m", 80, (LAT, LON)),
        ("height-above-takeoff [ft]", 80 / 0.3048, (LAT, LON)),
    ):
        path = write(tmp_path, "w.csv", f"Latitude,Lng,{column}\n{LAT},{LON},{value}\n")
        found = read_waypoint_set(path, dem, Assumed(home))
        assert found.waypoints[0].position_m == pytest.approx((0, 0, 80), abs=0.02), column
        assert bool(found.notes) == (home is not None)


def test_a_column_tells_each_row_its_reference(tmp_path, dem):
    """`alt` is above what height_reference says, row by row; another column is unused."""
    text = (
        "lat,lon,alt,height_reference,agl_m\n"
        f"{LAT},{LON},1580,AMSL,1\n{LAT},{LON + 9 * EAST},80,Above-Ground,1\n"
        f"{LAT},{LON + 19 * EAST},80,take-off,1\n"
    )
    found = read_waypoint_set(write(tmp_path, "w.csv", text), dem, Assumed((LAT, LON)))
    heights = [w.position_m[2] for w in found.waypoints]
    ground = float(dem.height(found.waypoints[1].position_m[0], 0.0))
    assert heights == pytest.approx([80, 80 + ground, 80], abs=0.05)
    assert found.notes[-1].endswith("not used: agl_m")


def test_other_separators_decimal_commas_and_marks(tmp_path, dem):
    """Semicolons or tabs, commas in decimals, a byte order mark, any line end, upper case, ß."""
    rows = ["lat;lon;agl_m;Heading (deg);pitch;Bemerkung", f"{LAT};{LON};80,5;12,25;-45;Straße"]
    for separator in ";\t":
        for end in ("\n", "\r\n", "\r"):
            text = end.join(row.replace(";", separator) for row in ("# made by hand", *rows)) + end
            path = write(tmp_path, f"Straße {len(end)}.CSV", ("\ufeff" + text).encode())
            found = read_waypoint_set(path, dem)
            (one,) = found.waypoints
            assert one.position_m[2] == pytest.approx(80.5, abs=0.02)
            assert (one.yaw_deg, one.pitch_deg) == (12.25, -45)
            assert found.notes == (f"{path}: not used: bemerkung",)


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


def action(name, **given):
    inner = [dji(key, value) for key, value in given.items()]
    return dji("action", dji("actionActuatorFunc", name), dji("actionActuatorFuncParam", *inner))


def group(*actions, trigger="reachPoint", every="", start=None, end=0):
    return dji(
        "actionGroup",
        "" if start is None else dji("actionGroupStartIndex", start),
        dji("actionGroupEndIndex", end),
        dji("actionTrigger", dji("actionTriggerType", trigger), dji("actionTriggerParam", every)),
        *actions,
    )


def stop(index, north_m, height, *groups, mode="smoothTransition", angle=0, poi="0,0,0"):
    heading = {
        "waypointHeadingMode": mode,
        "waypointHeadingAngle": angle,
        "waypointPoiPoint": poi,
    }
    return tag(
        "Placemark",
        tag("Point", tag("coordinates", f"\n{LON},{LAT + north_m * NORTH}\n")),
        dji("index", index),
        dji("executeHeight", height),
        dji("waypointHeadingParam", *(dji(key, value) for key, value in heading.items())),
        *groups,
    )


def wayline(*stops, mode="relativeToStartPoint"):
    return tag("Folder", dji("executeHeightMode", mode), dji("autoFlightSpeed", 5), *stops)


def djis(tmp_path, *waylines, config=""):
    body = WPML.format("".join(waylines))
    template = WPML.format("").replace("<wpml:missionConfig/>", dji("missionConfig", config))
    return kmz(tmp_path, wpmz__template_dot_kml=template, wpmz__waylines_dot_wpml=body)


TAKE_OFF = f"<wpml:takeOffRefPoint>{LAT},{LON},1552.3</wpml:takeOffRefPoint>"


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


DIALECTS = st.fixed_dictionaries(
    {
        "separator": st.sampled_from(",;\t"),
        "comma": st.booleans(),
        "mark": st.booleans(),
        "end": st.sampled_from(["\n", "\r\n", "\r"]),
        "suffix": st.sampled_from([".csv", ".CSV", ".Csv"]),
        "unit": st.sampled_from(["m", "ft"]),
        "above": st.sampled_from(["amsl", "agl", "home", "ellipsoid", "column"]),
        "place": st.tuples(st.floats(-190, 190), st.floats(-190, 190), st.floats(60, 900)),
        "view": st.tuples(st.floats(0, 359), st.floats(-90, 45)),
    }
)


@settings(deadline=None, derandomize=True, max_examples=60)
@given(DIALECTS)
def test_a_table_of_any_dialect_is_one_place(tmp_path_factory, dem, dialect):
    """Separator, decimal sign, mark, line end, suffix, unit and height reference: to 1 cm."""
    east, north, up = dialect["place"]
    lat, lon, alt = (float(value) for value in dem.to_geodetic((east, north, up)))
    ground = float(dem.to_geodetic((east, north, float(dem.height(east, north))))[2])
    home = float(dem.to_geodetic((0.0, 0.0, float(dem.height(0.0, 0.0))))[2])
    above = dialect["above"]
    geoid = float(geoid_height(lat, lon))
    base = {"agl": ground, "home": home, "ellipsoid": -geoid}.get(above, 0.0)
    height = (alt - base) / (0.3048 if dialect["unit"] == "ft" else 1.0)
    names = [f"alt ({dialect['unit']})", "height_reference"]
    values = [f"{height:.4f}", "amsl" if above == "column" else above]
    if above == "column":
        names, values = [f"alt_msl_{dialect['unit']}"], values[:1]
    yaw, pitch = dialect["view"]
    rows = [
        ["Latitude", "Longitude", *names, "Gimbal Pitch", "bearing"],
        [f"{lat:.9f}", f"{lon:.9f}", *values, f"{pitch:.3f}", f"{yaw:.3f}"],
    ]
    if dialect["comma"] and dialect["separator"] != ",":
        rows[1] = [value.replace(".", ",") for value in rows[1]]
    text = "".join(dialect["separator"].join(row) + dialect["end"] for row in rows)
    path = tmp_path_factory.mktemp("dialect") / f"Tabelle{dialect['suffix']}"
    path.write_bytes(text.encode("utf-8-sig" if dialect["mark"] else "utf-8"))
    (one,) = read_waypoints(path, dem, Assumed((LAT, LON)))
    assert one.position_m == pytest.approx((east, north, up), abs=0.01)
    assert (one.yaw_deg, one.pitch_deg) == pytest.approx((yaw, pitch), abs=1e-3)


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


def litchi(*rows, header=LITCHI):
    return header + "".join(f"{','.join(map(str, row))}\n" for row in rows)


def leg(
    north_m,
    height=80,
    heading=0,
    gimbal=(2, -90),
    actions=(-1, 0, -1, 0),
    mode=0,
    poi=(0, 0, 0, 0),
    often=(-1, -1),
):
    return (
        LAT + north_m * NORTH,
        LON,
        height,
        heading,
        0,
        0,
        *gimbal,
        *actions,
        mode,
        5,
        *poi,
        *often,
    )


def test_litchis_table(tmp_path, dem):
    """Photos, tilt and turn as actions, a point of interest, heights above ground or take-off."""
    text = litchi(
        leg(0, heading=45, gimbal=(2, -60), actions=(0, 2000, 1, 0)),
        leg(20, actions=(4, -90, 1, 0), gimbal=(0, 0)),
        leg(40, gimbal=(1, 0), actions=(1, 0, -1, 0), poi=(LAT + 80 * NORTH, LON, 40, 0)),
        leg(60),
        leg(80, 70, actions=(1, 0, -1, 0), mode=1),
    )
    path = write(tmp_path, "litchi.csv", text)
    found = read_waypoint_set(path, dem, Assumed((LAT, LON)))
    views = [(round(w.yaw_deg, 1), round(w.pitch_deg, 1)) for w in found.waypoints]
    assert views == [(45, -60), (270, -60), (0, -45), (0, -90)]
    x, y, z = found.waypoints[3].position_m
    assert z - float(dem.height(x, y)) == pytest.approx(70, abs=0.01)
    told = " ".join(found.notes)
    assert "curvesize_m, waiting × 1" in told
    assert "1 waypoints leave the gimbal as it is" in told
    with pytest.raises(WaypointError, match=r"line 2: .*set waypoints\.home_deg"):
        read_waypoints(path, dem)


def test_litchi_in_feet_and_by_distance(tmp_path, dem):
    """altitude(ft) and mph; a photo every 10 m from the first waypoint on."""
    header = LITCHI.replace("altitude(m)", "altitude(ft)").replace("speed(m/s)", "speed(mph)")
    rows = [leg(40 * k, 80 / 0.3048, often=(-1, 10 / 0.3048)) for k in range(2)]
    found = read_waypoints(
        write(tmp_path, "l.csv", litchi(*rows, header=header)), dem, Assumed((LAT, LON))
    )
    assert [w.position_m[1] for w in found] == pytest.approx(range(0, 41, 10), abs=0.1)
    assert found[0].position_m[2] == pytest.approx(80, abs=0.02)


def test_a_wayline_is_certified_like_any_waypoints(tmp_path, dem):
    """The share seen of a survey laid out in DJI's format is that of the same photos in a table."""
    photo = action("takePhoto")
    stops = [stop(k, 20 * k - 190, 80, group(photo), mode="followWayline") for k in range(20)]
    path = djis(tmp_path, wayline(*stops, mode="aboveGroundLevel"))
    table = "lat,lon,agl_m\n" + "".join(
        f"{LAT + (20 * k - 190) * NORTH},{LON},80\n" for k in range(20)
    )
    other = write(tmp_path, "w.csv", table)
    camera = Camera(17.3, 13.0, 15.0, 5280, 3956)
    seen = [certify_coverage(read_waypoints(p, dem), dem, camera).seen_once for p in (path, other)]
    assert 0.1 < seen[0] < 0.5
    assert seen[0] == pytest.approx(seen[1], abs=0.01)


BOMB = '<?xml version="1.0"?><!DOCTYPE kml [<!ENTITY a "ha"><!ENTITY b "&a;&a;">]><kml>&b;</kml>'
OUTSIDE = '<?xml version="1.0"?><!DOCTYPE kml SYSTEM "file:///etc/passwd"><kml/>'
GOOD = wayline(stop(0, 0, 80))
BAD = {
    "entities": ("w.kml", BOMB, "DOCTYPE"),
    "outside entity": ("w.kml", OUTSIDE, "DOCTYPE"),
    "no xml": ("w.kml", "<kml><Document>", "line 1, column"),
    "deep": ("w.kml", "<kml>" * 5000, "nested more than"),
    "other xml": ("w.kml", "<gpx/>", "begins with <gpx>"),
    "no kmz": ("w.kmz", KML.format(mark(0, 1580)), "is not a KMZ"),
    "cut kmz": ("w.kmz", b"PK\x03\x04 and no more", "cannot be unpacked"),
    "template": ("template.kml", WPML.format(""), "template of a DJI wayline"),
    "area": ("w.kml", KML.format("<Placemark><Polygon/></Placemark>"), "area.file"),
    "sea floor": ("w.kml", KML.format(mark(0, 5, "relativeToSeaFloor")), "(w): altitudeMode is"),
    "coordinates": ("w.kml", KML.format(mark(0, "1580,7")), "must be longitude,latitude,altitude"),
    "word": ("w.kml", KML.format(mark(0, "high")), "altitude is 'high'"),
    "empty line": ("w.kml", KML.format("<Placemark><LineString/></Placemark>"), "no coordinates"),
    "height mode": (
        "w.wpml",
        WPML.format(wayline(stop(0, 0, 80), mode="moon")),
        "wayline 1: exec",
    ),
    "no take-off": ("w.wpml", WPML.format(GOOD), "waypoint 0: its altitude is relative to home"),
    "heading mode": ("w.wpml", WPML.format(wayline(stop(0, 0, 80, mode="spin"))), "'spin'"),
    "trigger": (
        "w.wpml",
        WPML.format(wayline(stop(0, 0, 80, group(action("takePhoto"), trigger="moon")))),
        "actionTriggerType is 'moon'",
    ),
    "no end": (
        "w.wpml",
        WPML.format(
            wayline(stop(0, 0, 80, group(action("takePhoto"), trigger="multipleDistance", every=0)))
        ),
        "has no end",
    ),
    "no wayline": ("w.wpml", WPML.format(""), "has no wayline"),
    "unit": ("w.csv", f"lat,lon,alt(yd)\n{LAT},{LON},1700\n", "line 1: alt_yd is in 'yd'"),
    "radians": ("w.csv", f"lat,lon,alt,heading_rad\n{LAT},{LON},1580,1\n", "in radians"),
    "reference": (
        "w.csv",
        f"lat,lon,alt,height_reference\n{LAT},{LON},1580,moon\n",
        "line 2: height_reference is 'moon'",
    ),
    "local home": ("w.csv", "x_m,y_m,above_home_m\n0,0,80\n", "needs latitude and longitude"),
    "no home": ("w.csv", f"lat,lon,above_home_m\n{LAT},{LON},80\n", "waypoints.home_deg"),
    "litchi mode": ("w.csv", litchi(leg(0, mode=7)), "line 2: altitudemode is 7"),
    "litchi action": ("w.csv", litchi(leg(0, actions=(9, 0, -1, 0))), "actiontype1 is 9"),
    "litchi unit": (
        "w.csv",
        litchi(leg(0), header=LITCHI.replace("altitude(m)", "altitude(fathoms)")),
        "altitude is in 'fathoms'",
    ),
    "litchi poi": ("w.csv", litchi(leg(0, gimbal=(1, 0))), "name no place"),
}


@pytest.mark.parametrize("case", BAD, ids=str)
def test_bad_files_are_refused_with_item_and_cure(tmp_path, dem, case):
    """Each names the file, what is wrong where, and ends with what to do."""
    name, content, reason = BAD[case]
    path = write(tmp_path, name, content)
    with pytest.raises(WaypointError) as caught:
        read_waypoints(path, dem)
    told = str(caught.value)
    assert str(path) in told
    assert reason in told
    assert ". " in told or "must be" in told
    assert told.endswith((".", ")."))


def test_an_archive_that_grows_is_stopped(tmp_path, dem):
    """A member of more than 64 MiB once unpacked is not unpacked further."""
    path = tmp_path / "w.kmz"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("doc.kml", b" " * (65 * 2**20))
    with pytest.raises(WaypointError, match=r"doc\.kml is larger than 64 MiB"):
        read_waypoints(path, dem)
