"""Photo positions of other people's mission files."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from jfto_msgs_py.errors import WaypointError
from jfto_planner.coverage import Camera, certify_coverage, read_waypoint_set, read_waypoints
from jfto_world.terrain import load_dem

CASES = Path(__file__).parents[2] / "data/cases"
LAT, LON, GROUND = 46.2, 7.6, 1500.0
NORTH = 1 / 111_150.0


@pytest.fixture(scope="module")
def dem():
    """Sloping ground, 1500 m in the middle."""
    return load_dem(CASES / "00-ground.tif", center=(LAT, LON), size_m=(400.0, 400.0))


def wpl(tmp_path, *rows, home=GROUND, header="QGC WPL 110"):
    """A file of rows (command, frame, seven parameters)."""
    whole = [(16, 0, 0, 0, 0, 0, LAT, LON, home), *rows] if home is not None else list(rows)
    lines = [
        "\t".join(map(str, (seq, 0, frame, command, *params, 1)))
        for seq, (command, frame, *params) in enumerate(whole)
    ]
    path = tmp_path / "m.waypoints"
    path.write_text("\n".join([header, *lines]) + "\n")
    return path


def waypoint(north_m, height=80.0, yaw=0, frame=3, east_m=0.0):
    east = east_m * NORTH / math.cos(math.radians(LAT))
    return (16, frame, 0, 0, 0, yaw, LAT + north_m * NORTH, LON + east, height)


def do(command, *params):
    return (command, 2, *params, *[0] * (7 - len(params)))


def views(path, dem):
    return [(w.yaw_deg, w.pitch_deg) for w in read_waypoints(path, dem)]


def norths(path, dem):
    return [w.position_m[1] for w in read_waypoints(path, dem)]


def test_a_survey_is_photographed_along_its_lines(dem):
    """The trigger distance lays 176 photos along 8 lines of 380 m, and they show all the area."""
    found = read_waypoint_set(CASES / "02-survey-trigger.plan", dem)
    assert len(found.waypoints) == 176
    assert {round(w.yaw_deg) % 180 for w in found.waypoints} == {90}
    camera = Camera(17.3, 13.0, 15.0, 5280, 3956)
    assert certify_coverage(found.waypoints, dem, camera).seen_once == 1.0
    assert any("176 photo positions" in note for note in found.notes)


@pytest.mark.parametrize("step", [5.0, 7.5, 25.0, 33.3])
def test_distance_trigger_spacing(tmp_path, dem, step):
    """From the place where it is switched on, every `step` metres, across corners, until off."""
    rows = [waypoint(0), do(206, step, 0, 1), waypoint(100), waypoint(180), do(206, 0)]
    place = norths(wpl(tmp_path, *rows, waypoint(-50)), dem)
    assert place == pytest.approx([k * step for k in range(int(180 / step) + 1)], abs=0.3)


def test_without_a_first_photo_the_trigger_begins_a_step_on(tmp_path, dem):
    """Parameter 3 of command 206 is whether a photo is taken at once."""
    rows = [waypoint(0), do(206, 30), waypoint(100)]
    assert norths(wpl(tmp_path, *rows), dem) == pytest.approx([30, 60, 90], abs=0.3)


def test_time_trigger_needs_a_speed(tmp_path, dem):
    """Photos every 2 s at 5 m/s are 10 m apart; without a speed the file is refused."""
    shots = [do(2000, 0, 2, 0), waypoint(40), do(2001)]
    path = wpl(tmp_path, waypoint(0), do(178, 1, 5), *shots, waypoint(90))
    assert norths(path, dem) == pytest.approx([0, 10, 20, 30, 40], abs=0.3)
    interval = wpl(tmp_path, waypoint(0), do(178, 1, 5), do(214, 4000), waypoint(70))
    assert norths(interval, dem) == pytest.approx([20, 40, 60], abs=0.3)
    with pytest.raises(WaypointError, match=r"line 5: .* names no speed. Trigger it by distance"):
        read_waypoints(wpl(tmp_path, waypoint(0), *shots), dem)


def test_photos_one_by_one(tmp_path, dem):
    """With shutter commands only their places count; waypoints on the way are said to be passed."""
    rows = [waypoint(0), waypoint(30), do(203, 0, 0, 0, 0, 1), waypoint(60), do(2000, 0, 0, 1)]
    path = wpl(tmp_path, *rows, waypoint(90))
    assert norths(path, dem) == pytest.approx([30, 60], abs=0.3)
    assert any("4 waypoints only mark" in n for n in read_waypoint_set(path, dem).notes)


def test_photos_over_ground_follow_it(tmp_path, dem):
    """Between waypoints above terrain photos keep their height above it."""
    rows = [waypoint(-150, 60, frame=10), do(206, 50, 0, 1), waypoint(150, 90, frame=10)]
    for k, found in enumerate(read_waypoints(wpl(tmp_path, *rows), dem)):
        x, y, z = found.position_m
        assert z - float(dem.height(x, y)) == pytest.approx(60 + 5 * k, abs=0.1)


def test_headings_of_commands(tmp_path, dem):
    """CONDITION_YAW, absolute and relative, and its holding on, which is said."""
    assert [y for y, _ in views(CASES / "03-condition-yaw.plan", dem)] == [135, 250]
    rows = [do(115, 350), waypoint(0), do(115, 30, 0, 1, 1), waypoint(20)]
    rows += [do(115, 45, 0, -1, 1), waypoint(40), waypoint(60)]
    path = wpl(tmp_path, *rows)
    assert [y for y, _ in views(path, dem)] == [350, 20, 335, 335]
    assert any("taken to hold" in note for note in read_waypoint_set(path, dem).notes)
    with pytest.raises(WaypointError, match=r"line 3: turns by 30.* absolute heading"):
        read_waypoints(wpl(tmp_path, do(115, 30, 0, 1, 1), waypoint(0)), dem)


@pytest.mark.parametrize(
    ("command", "view"),
    [
        (do(205, -40, 0, 25), (125, -40)),
        (do(1000, -35, -20, "nan", "nan", 0), (80, -35)),
        (do(1000, -35, -20, "nan", "nan", 16), (340, -35)),
    ],
)
def test_gimbal_yaw_and_pitch(tmp_path, dem, command, view):
    """A gimbal's yaw adds to the heading, unless it is locked to north."""
    path = wpl(tmp_path, command, do(115, 100), waypoint(0))
    assert views(path, dem) == [view]


@pytest.mark.parametrize("roi", [195, 201])
def test_a_region_of_interest_is_looked_at(tmp_path, dem, roi):
    """Yaw and pitch point at the place until it is let go."""
    first = 3 if roi == 201 else 0
    place = (roi, 3, first, 0, 0, 0, LAT, LON, 30)
    rows = [place, waypoint(-50, 80), waypoint(50, 80), do(197), waypoint(60, 80)]
    south, north, free = views(wpl(tmp_path, *rows), dem)
    assert ((south[0] + 1) % 360, south[1]) == pytest.approx((1, -45), abs=0.5)
    assert north == pytest.approx((180, -45), abs=0.5)
    assert free == (0, -90)


def test_home_is_held_against_the_ground(tmp_path, dem):
    """Heights above home are refused where home is metres off, far away, or without altitude."""
    for name, alt in (("04-home-zero.plan", "0.0"), ("04b-home-low.plan", "1455.0")):
        with pytest.raises(WaypointError, match=rf"planned home.*altitude {alt} m.*1500\.0 m"):
            read_waypoints(CASES / name, dem)
    off = wpl(tmp_path, waypoint(0), home=GROUND + 300)
    with pytest.raises(WaypointError, match=r"300\.0 m below it"):
        read_waypoints(off, dem)
    near = read_waypoint_set(wpl(tmp_path, waypoint(0), home=GROUND + 8), dem)
    assert any("8.0 m below it" in note for note in near.notes)
    assert not read_waypoint_set(wpl(tmp_path, waypoint(0)), dem).notes
    # Heights that do not count from home need none.
    assert read_waypoints(wpl(tmp_path, waypoint(0, 60, frame=10), home=0), dem)


def test_a_home_elsewhere(tmp_path, dem):
    """Farther than a multirotor flies it is refused; beyond the terrain it is said."""
    path = wpl(tmp_path, waypoint(0))
    text = path.read_text()
    path.write_text(text.replace(f"{LAT}\t{LON}\t{GROUND}", "47.39\t8.54\t488", 1))
    with pytest.raises(WaypointError, match="km from the scenario's origin"):
        read_waypoints(path, dem)
    path.write_text(text.replace(f"{LAT}\t{LON}\t{GROUND}", f"{LAT + 0.02}\t{LON}\t{GROUND}", 1))
    assert any("could not be compared" in note for note in read_waypoint_set(path, dem).notes)


def test_a_file_without_home(tmp_path, dem):
    """QGC WPL 120 has no row of home: heights above home are refused, others read."""
    old = "QGC WPL 120"
    with pytest.raises(WaypointError, match="relative to home"):
        read_waypoints(wpl(tmp_path, waypoint(0), home=None, header=old), dem)
    path = wpl(tmp_path, waypoint(0, 60, frame=10), home=None, header=old)
    assert len(read_waypoints(path, dem)) == 1


def test_an_idle_mission_has_nothing_to_photograph(tmp_path, dem):
    """LOITER_TIME is passed over beside waypoints; alone it is named in the refusal."""
    loiter = (19, 3, 30, 0, 0, 0, LAT, LON, 60)
    found = read_waypoint_set(wpl(tmp_path, waypoint(0), loiter), dem)
    assert len(found.waypoints) == 1
    assert any("loiter for a time (19)" in note for note in found.notes)
    with pytest.raises(WaypointError, match="loiter for a time"):
        read_waypoints(wpl(tmp_path, loiter), dem)


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "latin-1"])
@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_encodings_and_line_ends(tmp_path, dem, encoding, end):
    """Comments in any of them; another encoding than UTF-8 is said."""
    text = (CASES / "08-latin1.waypoints").read_bytes().decode("latin-1")
    path = tmp_path / "M.WAYPOINTS"
    path.write_bytes(text.replace("\n", end).encode(encoding))
    found = read_waypoint_set(path, dem)
    assert len(found.waypoints) == 1
    told = [note for note in found.notes if "is not in UTF-8" in note]
    assert len(told) == (encoding in ("utf-16", "latin-1"))


def test_geojson_of_other_programs(tmp_path, dem):
    """Heading and gimbal angle under other names, numbers as text; the rest is said."""
    found = read_waypoint_set(CASES / "11-dronetm.geojson", dem)
    assert [(w.yaw_deg, w.pitch_deg) for w in found.waypoints] == [(90, -80)] * 3
    assert found.notes == (f"{CASES / '11-dronetm.geojson'}: not used: index",)
    text = (CASES / "11-dronetm.geojson").read_text()
    path = tmp_path / "A.GEOJSON"
    path.write_text(text.replace('"take_photo": true', '"take_photo": false', 1))
    less = read_waypoint_set(path, dem)
    assert len(less.waypoints) == 2
    assert any("left out" in note for note in less.notes)
    path.write_text(text.replace('"heading": 90.0', '"heading": 90.0, "Yaw": 10', 1))
    with pytest.raises(WaypointError, match=r"yaw 10 and heading 90"):
        read_waypoints(path, dem)
    crs = '"crs": {"type": "name", "properties": {"name": "EPSG:2056"}},'
    path.write_text(text.replace("{", "{" + crs, 1))
    with pytest.raises(WaypointError, match=r"EPSG:2056.*Reproject"):
        read_waypoints(path, dem)


def test_an_area_is_told_from_waypoints(dem):
    """The refusal says how it is photographed."""
    with pytest.raises(
        WaypointError, match=r"an area;.*set waypoints\.source to coverage and area"
    ):
        read_waypoints(CASES / "12-area.geojson", dem)


def test_a_home_that_is_moved_is_refused(tmp_path, dem):
    """Heights after it would count from another place."""
    with pytest.raises(WaypointError, match=r"line 4: moves home \(179\)"):
        read_waypoints(wpl(tmp_path, waypoint(0), do(179, 1), waypoint(20)), dem)


def test_speeds_and_jumps_are_said(tmp_path, dem):
    """Neither changes where photos are taken, and the line names both."""
    path = wpl(tmp_path, waypoint(0), do(178, 1, 5), waypoint(20), do(177, 1, 3))
    (note,) = read_waypoint_set(path, dem).notes
    assert note.endswith("passed over: speed (178) × 1, jump (177) × 1")


def test_a_plan_under_another_name_is_told(tmp_path, dem):
    """Its JSON is no GeoJSON."""
    path = tmp_path / "m.json"
    path.write_bytes((CASES / "03-condition-yaw.plan").read_bytes())
    with pytest.raises(WaypointError, match=r"Name it \.plan"):
        read_waypoints(path, dem)
