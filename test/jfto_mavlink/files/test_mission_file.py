"""Mission files in both formats."""

from __future__ import annotations

import dataclasses
import json

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from jfto_mavlink.errors import MissionFileError
from jfto_mavlink.files import read_mission, write_mission
from jfto_mavlink.files.mission_of_document import mission_of_document
from jfto_mavlink.files.qgc_plan import plan_document
from jfto_mavlink.files.wpl import wpl_text
from jfto_mavlink.mission.build import build_missions
from jfto_mavlink.mission.fence import Circle, Fence, Polygon, RallyPoint, fence_items, rally_items
from jfto_mavlink.mission.settings import MissionSettings
from jfto_mavlink.mission.stored import diff_missions, mission_hash
from jfto_mavlink.protocol.item import Item, Mission
from jfto_msgs_py.mission_file.plan_json import plan_of_document
from jfto_msgs_py.mission_file.wpl_text import parse_wpl_text

FENCE = Fence(
    (
        Polygon(((47.39, 8.54), (47.40, 8.54), (47.40, 8.56), (47.39, 8.56))),
        Polygon(((47.391, 8.541), (47.392, 8.541), (47.392, 8.542)), inclusion=False),
    ),
    (Circle((47.395, 8.55), 450.5), Circle((47.3955, 8.551), 20.0, inclusion=False)),
    (47.3977, 8.5456),
)
RALLY = (RallyPoint((47.3978, 8.5457), 30.0), RallyPoint((47.3979, 8.5458), 45.0))

single = st.floats(-1e6, 1e6, width=32)
items = st.builds(
    Item,
    st.sampled_from([16, 19, 22, 82, 93, 115, 178, 203, 205, 206, 2000]),
    st.sampled_from([0, 2, 3, 10]),
    st.tuples(single, single, single, single),
    st.integers(-(2**31), 2**31 - 1),
    st.integers(-(2**31), 2**31 - 1),
    single,
    st.just(0),
    st.sampled_from([0, 1]),
)
missions = st.lists(items, min_size=1, max_size=12).map(
    lambda rest: (Item(16, 0, x=473_977_420, y=85_455_940, z=488.1), *rest)
)


def parse_wpl(text, name):
    return mission_of_document(parse_wpl_text(text, name), name)


def parse_document(document):
    return mission_of_document(plan_of_document(document, "x"), "x")


@pytest.mark.slow
@settings(max_examples=80, deadline=None, derandomize=True)
@given(missions)
def test_both_formats_keep_every_bit(rest):
    """Read what was written: the same items, to the last bit of every float and coordinate."""
    assert parse_wpl(wpl_text(rest), "x").items == rest
    document = json.loads(json.dumps(plan_document(Mission(rest))))
    assert parse_document(document).items == rest


@pytest.mark.parametrize("name", ["m.plan", "m.waypoints"])
def test_a_built_mission_with_fence_and_rally_survives_a_file(plan, tmp_path, name):
    """The hash over the stored form is the same before and after."""
    built = build_missions(plan, MissionSettings(), FENCE, RALLY)[0].mission
    written = write_mission(tmp_path / name, built)
    assert len(written) == (1 if name.endswith("plan") else 3)
    back = read_mission(tmp_path / name)
    kept = built if name.endswith("plan") else dataclasses.replace(built, parameters=())
    assert back == kept
    assert mission_hash(back) == mission_hash(built)
    assert diff_missions(kept, back) == ()


def test_parameters_ride_along_in_a_plan(tmp_path):
    """A plan has no field of its own for them; QGroundControl reads past ours."""
    mission = Mission((), fence_items(FENCE), (), (("FENCE_ALT_MAX", 120.0),))
    write_mission(tmp_path / "f.plan", mission)
    assert read_mission(tmp_path / "f.plan") == mission


def test_a_survey_item_is_expanded():
    """QGroundControl keeps the simple items of a survey inside it."""
    inner = plan_document(Mission((Item(16, 0), Item(22, 3, z=10.0), Item(16, 3, x=5, z=9.0))))
    survey = {
        "type": "ComplexItem",
        "complexItemType": "survey",
        "TransectStyleComplexItem": {"Items": inner["mission"]["items"]},
    }
    inner["mission"]["items"] = [survey]
    assert [item.command for item in parse_document(inner).items] == [16, 22, 16]


def test_files_of_other_stations_are_read():
    """Spaces for tabs, comments, few digits, a null for "no place"."""
    text = (
        "QGC WPL 110\r\n0 1 0 16 0 0 0 0 47.4 8.5 488 1\r\n# note\r\n1 0 3 22 0 0 0 0 0 0 20 1\r\n"
    )
    assert [i.command for i in parse_wpl(text, "x").items] == [16, 22]
    document = plan_document(Mission((Item(16, 0), Item(22, 3, z=10.0))))
    document["mission"]["items"][0]["params"][3:6] = [None, None, None]
    item = parse_document(document).items[1]
    assert (item.x, item.y) == (0, 0)


@pytest.mark.parametrize(
    ("name", "text", "words"),
    [
        ("a.waypoints", "WPL 100\n", "must begin"),
        ("a.waypoints", "QGC WPL 110\n0\t1\t0\n", "line 2: has 3 columns"),
        ("a.waypoints", "QGC WPL 110\n1 1 0 16 0 0 0 0 0 0 0 1\n", "item number 1, expected 0"),
        ("a.waypoints", "QGC WPL 110\n0 1 0 x 0 0 0 0 0 0 0 1\n", "line 2"),
        ("a.plan", "{", "cannot be read"),
        ("a.plan", '{"fileType": "Plan"}', "mission"),
        ("a.plan", '{"fileType": "GeoFence", "mission": {}}', "fileType"),
        ("a.kml", "", "must end in"),
    ],
)
def test_a_broken_file_is_refused_with_its_place(tmp_path, name, text, words):
    """The message names file and line."""
    path = tmp_path / name
    path.write_text(text)
    with pytest.raises(MissionFileError, match=words) as caught:
        read_mission(path)
    assert "a." in str(caught.value)


def test_a_missing_file_is_said_to_be_missing(tmp_path):
    """Not a traceback."""
    with pytest.raises(MissionFileError, match="no such file"):
        read_mission(tmp_path / "none.waypoints")


def test_a_diff_names_what_changed():
    """Inserted, removed and changed items, as the autopilot would store them."""
    old = Mission((Item(16, 0), Item(22, 3, z=10.0), Item(16, 3, x=1, y=2, z=20.0)))
    new = Mission((Item(16, 0), Item(22, 3, z=12.0), Item(16, 3, x=1, y=2, z=20.0)))
    lines = diff_missions(old, new)
    assert [line[:11] for line in lines] == ["- mission 1", "+ mission 1"]
    assert diff_missions(old, old) == ()
    assert diff_missions(old, Mission(old.items, rally=rally_items(RALLY)))[0][:7] == "+ rally"
