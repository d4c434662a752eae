"""Any file that pymavlink's loader or QGroundControl's format allows: its items, or refused."""

from __future__ import annotations

import json
import math

from hypothesis import event, given, settings
from hypothesis import strategies as st
from pymavlink.mavwp import MAVWPLoader

from jfto_mavlink.errors import MissionFileError
from jfto_mavlink.files import read_mission
from jfto_mavlink.protocol.item import DEGREE_1E7, Item, float32

COMMANDS = (16, 17, 18, 19, 20, 21, 22, 82, 93, 112, 115, 177, 178, 189, 195, 197, 201, 203, 205,
            206, 214, 530, 1000, 2000, 2001, 5003, 5100)  # fmt: skip
number = st.one_of(
    st.integers(-1000, 1000).map(float),
    st.floats(-1e6, 1e6, allow_nan=False),
    st.sampled_from([0.0, math.nan, 1e-7, 206.0]),
)
place = st.tuples(st.floats(-90, 90), st.floats(-180, 180))
shown = st.sampled_from(["{:f}", "{:.8f}", "{:g}", "{!r}", "{:.3e}"])
rows = st.tuples(
    st.sampled_from(COMMANDS),
    st.sampled_from([0, 2, 3, 5, 6, 10, 11]),
    st.tuples(number, number, number, number),
    place,
    st.floats(-1000, 9000),
).map(lambda row: row if Item(row[0]).has_position else (*row[:3], (0.0, 0.0), row[4]))


@settings(max_examples=150, deadline=None, derandomize=True)
@given(
    st.lists(rows, max_size=8),
    shown,
    st.sampled_from(["\t", " ", "   ", "\t\t"]),
    st.sampled_from(["\n", "\r\n"]),
    st.lists(st.sampled_from(["", "# remark", "  "]), max_size=3),
)
def test_what_pymavlinks_loader_reads(tmp_path_factory, entries, form, gap, end, between):
    """The same commands, frames, parameters and places to 1e-7 degrees, or a refusal."""
    path = tmp_path_factory.mktemp("wpl") / "m.waypoints"
    lines = ["QGC WPL 110", "0\t1\t0\t16\t0\t0\t0\t0\t46.2\t7.6\t1500\t1"]
    for seq, (command, frame, params, where, height) in enumerate(entries, start=1):
        values = (form.format(value) for value in (*params, *where, height))
        lines += [*between, gap.join([str(seq), "0", str(frame), str(command), *values, "1"])]
    path.write_text(end.join([*lines, ""]), newline="")
    loader = MAVWPLoader()
    loader.load(str(path))
    mission = read_or_refused(path)
    if mission is None:
        return
    ours = sorted(map(_of_item, (*mission.items[1:], *mission.fence, *mission.rally)), key=repr)
    theirs = sorted((_of_message(w) for w in loader.wpoints[1:]), key=repr)
    assert len(ours) == len(theirs)
    assert ours == theirs


def read_or_refused(path):
    """The mission; None where the file is refused by name."""
    try:
        mission, told = read_mission(path), ""
    except MissionFileError as error:
        mission, told = None, str(error)
    assert mission is not None or str(path) in told
    event("refused" if told else "read")
    return mission


def _of_item(item):
    scale = DEGREE_1E7 if item.has_position else 1
    return (item.command, item.frame, *(_plain(p) for p in item.params),
            item.x / scale, item.y / scale, _plain(item.z))  # fmt: skip


def _of_message(message):
    # Open headings and reserved parameters are 0 to a vehicle.
    from jfto_msgs_py.mission_file import FileItem

    values = [getattr(message, f"param{k}") for k in range(1, 5)]
    values += [message.x, message.y, message.z]
    item = FileItem("", message.command, message.frame, tuple(values))
    x, y = (round(value, 7) for value in item.params[4:6])
    params = (_plain(float32(p)) for p in item.params[:4])
    return (item.command, item.frame, *params, x, y, _plain(float32(item.params[6])))


def _plain(value):
    return "nan" if math.isnan(value) else value + 0.0


simple = rows.map(
    lambda row: {
        "type": "SimpleItem",
        "autoContinue": True,
        "command": row[0],
        "doJumpId": 1,
        "frame": row[1],
        "params": [None if math.isnan(v) else v for v in (*row[2], *row[3], row[4])],
    }
)
survey = st.tuples(st.sampled_from(["survey", "CorridorScan"]), st.lists(simple, max_size=4)).map(
    lambda pair: {
        "type": "ComplexItem",
        "complexItemType": pair[0],
        "version": 5,
        "TransectStyleComplexItem": {"version": 2, "CameraCalc": {}, "Items": pair[1]},
    }
)
corner = st.tuples(st.floats(-90, 90), st.floats(-180, 180)).map(list)
plans = st.fixed_dictionaries(
    {
        "items": st.lists(st.one_of(simple, survey), max_size=6),
        "polygons": st.lists(st.lists(corner, min_size=3, max_size=5), max_size=2),
        "circles": st.lists(st.tuples(corner, st.floats(1, 500)), max_size=2),
        "points": st.lists(st.tuples(corner, st.floats(0, 500)), max_size=3),
    }
)


@settings(max_examples=150, deadline=None, derandomize=True)
@given(plans)
def test_what_qgroundcontrols_format_allows(tmp_path_factory, wanted):
    """Simple items, surveys and corridor scans, polygons, circles and rally points all come out."""
    path = tmp_path_factory.mktemp("plan") / "m.plan"
    fence = {
        "version": 2,
        "polygons": [{"version": 1, "inclusion": True, "polygon": p} for p in wanted["polygons"]],
        "circles": [
            {"version": 1, "inclusion": False, "circle": {"center": c, "radius": r}}
            for c, r in wanted["circles"]
        ],
    }
    mission = {"version": 2, "items": wanted["items"], "plannedHomePosition": [46.2, 7.6, 1500]}
    rally = {"version": 2, "points": [[*c, height] for c, height in wanted["points"]]}
    document = {"fileType": "Plan", "version": 1, "mission": mission, "geoFence": fence}
    path.write_text(json.dumps(document | {"rallyPoints": rally}))
    flat = [
        item
        for entry in wanted["items"]
        for item in ([entry] if "params" in entry else entry["TransectStyleComplexItem"]["Items"])
    ]
    found = read_or_refused(path)
    if found is None:
        return
    shapes = sum(map(len, wanted["polygons"])) + len(wanted["circles"])
    assert len(found.items[1:]) + len(found.fence) + len(found.rally) == (
        len(flat) + shapes + len(wanted["points"])
    )
    listed = [item for item in flat if item["command"] < 5000]
    for item, entry in zip(found.items[1:], listed, strict=True):
        given_ = [math.nan if v is None else float32(v) for v in entry["params"][:4]]
        assert (item.command, item.frame) == (entry["command"], entry["frame"])
        for ours, theirs in zip(item.params, given_, strict=True):
            assert ours == theirs or (math.isnan(theirs) and (ours == 0 or math.isnan(ours)))
        assert abs(item.lat_deg - entry["params"][4]) < 1e-7 or not item.has_position
