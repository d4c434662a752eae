"""Mission files of other programs: read whole, or refused with file, item, reason and cure."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from jfto_mavlink.errors import MissionError, MissionFileError
from jfto_mavlink.files import read_mission, write_mission
from jfto_mavlink.mission.limits import MissionLimits, check_limits

CASES = Path(__file__).parents[2] / "data/cases"


def plan(tmp_path, change):
    """The first case, changed."""
    document = json.loads((CASES / "01-qgc-null-yaw.plan").read_text())
    change(document)
    path = tmp_path / "m.plan"
    path.write_text(json.dumps(document))
    return path


def wpl(tmp_path, *rows, header="QGC WPL 110"):
    path = tmp_path / "m.waypoints"
    path.write_text("\n".join([header, *rows]) + "\n")
    return path


HOME = "0 1 0 16 0 0 0 0 46.2 7.6 1500 1"
UP = "1 0 3 22 0 0 0 0 46.2 7.6 20 1"


@pytest.mark.parametrize("command", [16, 21, 22, 82])
def test_an_open_heading_is_zero(tmp_path, command):
    """QGroundControl writes null, others nan, for a heading that is left to the vehicle."""

    def change(document):
        document["mission"]["items"][1]["command"] = command

    mission = read_mission(plan(tmp_path, change))
    assert [item.params[3] for item in mission.items] == [0.0] * 5
    check_limits("m", mission.items, MissionLimits())
    row = f"2 0 3 {command} 0 0 0 nan 46.2001 7.6001 60 1"
    assert read_mission(wpl(tmp_path, HOME, UP, row)).items[2].params[3] == 0.0


def test_reserved_parameters_of_the_camera_may_be_open(tmp_path):
    """Hover-and-capture surveys leave four of seven open."""
    shot = {"type": "SimpleItem", "command": 2000, "frame": 2, "autoContinue": True}
    shot["params"] = [0, 0, 1, None, None, None, None]
    path = plan(tmp_path, lambda d: d["mission"]["items"].insert(2, shot))
    check_limits("m", read_mission(path).items, MissionLimits())


def test_another_open_parameter_is_named(tmp_path):
    """Where 0 would mean something else, the check says which parameter of which item."""

    def change(document):
        document["mission"]["items"][1]["params"][0] = None

    with pytest.raises(MissionError, match=r"item 2: parameter 1 of command 16 is not a finite"):
        check_limits("m", read_mission(plan(tmp_path, change)).items, MissionLimits())


@pytest.mark.parametrize("index", [4, 5, 6])
def test_an_open_place_is_refused(tmp_path, index):
    """A waypoint without latitude, longitude or height is never one at 0."""

    def change(document):
        document["mission"]["items"][1]["params"][index] = None

    with pytest.raises(MissionFileError, match=r"tude of command 16 is left open\. Set it"):
        read_mission(plan(tmp_path, change))
    row = ["2", "0", "3", "16", "0", "0", "0", "0", "46.2001", "7.6001", "60", "1"]
    row[index + 4] = "nan"
    with pytest.raises(MissionFileError, match=r"tude of command 16 is left open\. Set it"):
        read_mission(wpl(tmp_path, HOME, UP, " ".join(row)))


def test_heights_above_the_terrain_are_said(tmp_path):
    """Without terrain data a vehicle descends there."""
    row = "2 0 10 16 0 0 0 0 46.2001 7.6001 60 1"
    notes = read_mission(wpl(tmp_path, HOME, UP, row)).notes
    assert any("1 items are above the terrain" in note for note in notes)


def test_rally_and_fence_among_waypoints_are_kept(tmp_path):
    """A list of all kinds is sorted, and nothing of it is dropped."""
    mission = read_mission(CASES / "06-rally-in-mission.waypoints")
    assert (len(mission.items), len(mission.rally)) == (3, 1)
    corners = [f"{k} 0 0 5001 3 0 0 0 46.{k} 7.6 0 1" for k in (2, 3, 4)]
    mixed = read_mission(wpl(tmp_path, HOME, UP, *corners, "5 0 3 16 0 0 0 0 46.2 7.6 60 1"))
    assert (len(mixed.items), len(mixed.fence)) == (3, 3)
    with pytest.raises(MissionFileError, match="polygon is incomplete"):
        read_mission(wpl(tmp_path, HOME, UP, *corners[:2]))


def test_a_fence_beside_a_mission_holds_nothing_else(tmp_path):
    """Waypoints in `x.fence.waypoints` are not slipped into the mission, nor dropped."""
    path = wpl(tmp_path, HOME, UP)
    (tmp_path / "m.fence.waypoints").write_text(path.read_text())
    with pytest.raises(MissionFileError, match="its fence only"):
        read_mission(path)


def test_suffix_and_header_variants(tmp_path):
    """Upper-case suffixes, and the header of files without home."""
    for name in ("M.PLAN", "M.WAYPOINTS"):
        source = CASES / ("01-qgc-null-yaw.plan" if "PLAN" in name else "08-latin1.waypoints")
        (tmp_path / name).write_bytes(source.read_bytes())
        assert len(read_mission(tmp_path / name).items) > 2
        assert write_mission(tmp_path / name, read_mission(tmp_path / name))
    rows = ["0 1 3 22 0 0 0 0 46.2 7.6 20 1", "1 0 3 16 0 0 0 0 46.2001 7.6 60 1"]
    mission = read_mission(wpl(tmp_path, *rows, header="QGC WPL 120"))
    assert [item.command for item in mission.items] == [16, 22, 16]
    assert "names no home" in mission.notes[0]


def test_what_is_not_taken_over_is_named(tmp_path):
    """Unknown keys of every part in one line; the survey's own layout."""

    def change(document):
        document["weather"] = "fine"
        document["mission"]["items"][0]["note"] = "x"
        document["rallyPoints"]["colour"] = "red"

    (note,) = read_mission(plan(tmp_path, change)).notes
    assert note.endswith("not used: item.note, rallyPoints.colour, weather")
    (note,) = read_mission(CASES / "02-survey-trigger.plan").notes
    assert "survey" in note


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda d: d.update(version=2), "is of version 2"),
        (lambda d: d["mission"].update(version=1), "mission: is of version 1"),
        (lambda d: d["geoFence"].update(version=3), "geoFence: is of version 3"),
        (lambda d: d["rallyPoints"].update(version=1), "rallyPoints: is of version 1"),
        (lambda d: d["mission"]["items"][1].update(command=16.5), "item 2: command is 16.5"),
        (lambda d: d["mission"]["items"][1].update(command="16"), "item 2: command is '16'"),
        (lambda d: d["mission"]["items"][1].update(frame=None), "item 2: frame is None"),
        (lambda d: d["mission"]["items"][1]["params"].append(0), "item 2: params"),
        (lambda d: d["mission"]["items"][1].update(params=[True] * 7), r"params\[0\] is True"),
        (lambda d: d["mission"].update(plannedHomePosition=[1, 2]), "plannedHomePosition"),
        (lambda d: d["mission"].update(plannedHomePosition=[95, 2, 0]), "not on Earth"),
        (lambda d: d["rallyPoints"].update(points=[[1, 2]]), "rally point 0"),
        (lambda d: d["geoFence"].update(polygons=[{"polygon": []}]), "polygon 0: inclusion"),
        (lambda d: d["geoFence"].update(circles=[7]), "circle 0"),
        (
            lambda d: d["mission"]["items"].append(
                {"type": "ComplexItem", "complexItemType": "StructureScan"}
            ),
            "item 5: is a 'StructureScan' item, .*only QGroundControl can expand it",
        ),
    ],
)
def test_what_cannot_be_read_rightly_is_refused(tmp_path, change, words):
    """Versions of parts, numbers that are none, shapes, items that hold no waypoints."""
    path = plan(tmp_path, change)
    with pytest.raises(MissionFileError, match=words) as caught:
        read_mission(path)
    assert str(path) in str(caught.value)


def test_a_doubled_key_is_refused(tmp_path):
    """JSON readers keep the last of two; here neither is dropped unsaid."""
    path = tmp_path / "m.plan"
    text = (CASES / "01-qgc-null-yaw.plan").read_text()
    path.write_text(text.replace('"version":2', '"items":[],"version":2', 1))
    path.write_text(text.replace('"mission":{', '"mission":{"items":[],', 1))
    with pytest.raises(MissionFileError, match="'items' is given twice"):
        read_mission(path)


@pytest.mark.parametrize(
    ("row", "words"),
    [
        ("2 0 3 16 0 0 0 0 46,2 7.6 60 1", "must be a number with a decimal point"),
        ("2 0 3 16 0 0 0 0 46.2 7.6 1_0 1", "column 11"),
        ("2 0 3 16 0 0 0 0 460.2 7.6 60 1", "cannot carry"),
        ("2 0 3 115.5 0 0 0 0 0 0 0 1", "command is 115.5"),
        ("2 0 3 203 0 0 0 0 0.5 0 0 1", "parameter 5 of command 203 is 0.5"),
        ("2 0 3 16 1e39 0 0 0 46.2 7.6 60 1", "too large"),
        ("3 0 3 16 0 0 0 0 46.2 7.6 60 1", "item number 3, expected 2"),
    ],
)
def test_rows_that_cannot_be_carried_are_refused(tmp_path, row, words):
    """Commas for points, numbers beyond an item's fields, a missing line."""
    with pytest.raises(MissionFileError, match=words):
        read_mission(wpl(tmp_path, HOME, UP, row))


def test_a_first_row_that_is_no_home_is_refused(tmp_path):
    """It would be taken for home, and the take-off would be gone."""
    with pytest.raises(MissionFileError, match="first row of QGC WPL 110 is home"):
        read_mission(wpl(tmp_path, "0 1 3 22 0 0 0 0 46.2 7.6 20 1"))


def test_a_rally_point_in_a_frame_that_a_plan_lacks(tmp_path):
    """Its height would change its meaning: written as .waypoints, refused as .plan."""
    path = wpl(tmp_path, HOME, UP, "2 0 0 5100 0 0 0 0 46.2 7.6 1550 1")
    mission = read_mission(path)
    with pytest.raises(MissionFileError, match="heights above home"):
        write_mission(tmp_path / "n.plan", mission)
    write_mission(tmp_path / "n.waypoints", mission)
    assert read_mission(tmp_path / "n.waypoints") == mission


def test_a_fence_of_an_earlier_mission_is_not_left_beside(tmp_path):
    """It would be read with the new mission, which has none."""
    mission = read_mission(wpl(tmp_path, HOME, UP))
    (tmp_path / "n.fence.waypoints").write_text("QGC WPL 110\n")
    with pytest.raises(MissionFileError, match=r"n\.fence\.waypoints: lies there from an earlier"):
        write_mission(tmp_path / "n.waypoints", mission)


def test_a_file_cut_after_its_first_line_is_refused(tmp_path):
    """A header alone is no empty mission: something was lost."""
    for header in ("QGC WPL 110", "QGC WPL 120"):
        with pytest.raises(MissionFileError, match="first line and nothing else"):
            read_mission(wpl(tmp_path, header=header))


def test_an_empty_mission_is_written_with_home(tmp_path):
    """And comes back empty, in both formats."""
    empty = read_mission(plan(tmp_path, lambda d: d["mission"].update(items=[])))
    write_mission(tmp_path / "n.waypoints", empty)
    assert read_mission(tmp_path / "n.waypoints").items == ()


@pytest.mark.parametrize(
    "rows", [(UP,), ("1 0 3 178 1 5 -1 0 0 0 0 1", UP.replace("1 0", "2 0", 1))]
)
def test_a_row_of_home_where_none_belongs_is_named(tmp_path, rows):
    """QGC WPL 120 has none: a waypoint above sea level before the take-off was meant for home."""
    with pytest.raises(MissionFileError, match=r"have no row of home, but this one looks like it"):
        read_mission(wpl(tmp_path, HOME, *rows, header="QGC WPL 120"))


def test_a_jump_leads_to_an_item_that_is_there(tmp_path):
    """Past the end, to home, to a fraction: a vehicle would end its mission there."""
    point = "2 0 3 16 0 0 0 0 46.2001 7.6001 60 1"
    assert len(read_mission(wpl(tmp_path, HOME, UP, point, "3 0 2 177 2 3 0 0 0 0 0 1")).items) == 4
    for target in ("4", "0", "2.5", "nan", "-1"):
        row = f"3 0 2 177 {target} 3 0 0 0 0 0 1"
        with pytest.raises(MissionFileError, match=r"jumps to item .*the mission has items 1 to 3"):
            read_mission(wpl(tmp_path, HOME, UP, point, row))
    with pytest.raises(MissionFileError, match="jumps to tag 7, which no item sets"):
        read_mission(wpl(tmp_path, HOME, UP, "2 0 2 601 7 1 0 0 0 0 0 1"))


def test_jumps_go_by_the_numbers_of_the_file(tmp_path):
    """QGroundControl's doJumpId leaves gaps, and fence points are taken out of the list."""

    def change(document):
        for number, item in zip((1, 12, 13, 14), document["mission"]["items"], strict=True):
            item["doJumpId"] = number
        jump = {"type": "SimpleItem", "command": 177, "frame": 2, "autoContinue": True}
        jump |= {"doJumpId": 15, "params": [13, 2, 0, 0, 0, 0, 0]}
        document["mission"]["items"].append(jump)

    assert read_mission(plan(tmp_path, change)).items[5].params[0] == 3.0
    corners = [f"{k} 0 0 5001 3 0 0 0 46.{k} 7.6 0 1" for k in (2, 3, 4)]
    rows = [*corners, "5 0 3 16 0 0 0 0 46.2 7.6 60 1", "6 0 2 177 5 1 0 0 0 0 0 1"]
    assert read_mission(wpl(tmp_path, HOME, UP, *rows)).items[3].params[0] == 2.0


@pytest.mark.parametrize(
    ("kind", "words"),
    [(1, "a plane"), (10, "a rover"), (20, "a VTOL plane"), (99, "no copter"), ("x", "no copter")],
)
def test_a_plan_for_another_kind_of_vehicle_says_so(tmp_path, kind, words):
    """Planes circle where copters stop; for copters of any size nothing is said."""
    path = plan(tmp_path, lambda d: d["mission"].update(vehicleType=kind))
    assert f"was made for {words} (vehicleType {kind!r})" in " ".join(read_mission(path).notes)
    path = plan(tmp_path, lambda d: d["mission"].update(vehicleType=13))
    assert "vehicleType" not in " ".join(read_mission(path).notes)


@pytest.mark.parametrize("command", [21, 22])
def test_an_open_place_of_take_off_or_landing_is_named(tmp_path, command):
    """Both take 0 for "here"; it is said which, and of which item."""

    def change(document):
        document["mission"]["items"][1]["command"] = command
        document["mission"]["items"][1]["params"][4] = None

    (note,) = read_mission(plan(tmp_path, change)).notes
    assert note.endswith(
        f"item 2: the latitude of command {command} left open: 0 is written, where it is"
    )
    row = f"2 0 3 {command} 0 0 0 0 nan nan 60 1"
    (note,) = read_mission(wpl(tmp_path, HOME, UP, row)).notes
    assert f"the latitude and longitude of command {command} left open" in note


def test_an_open_height_of_home_is_the_same_in_both_formats(tmp_path):
    """0 m, and it is said."""
    row = "2 0 3 16 0 0 0 0 46.2001 7.6001 60 1"
    both = [
        wpl(tmp_path, HOME.replace("1500", "nan"), UP, row),
        plan(tmp_path, lambda d: d["mission"].update(plannedHomePosition=[46.2, 7.6, None])),
    ]
    for path in both:
        mission = read_mission(path)
        assert (mission.items[0].lat_deg, mission.items[0].z) == (46.2, 0.0)
        assert mission.notes == (f"{path}: the altitude of home is left open, 0 m is written",)
