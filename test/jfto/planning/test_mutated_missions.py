"""Whatever is wrong in a mission file: read whole or refused, and never a traceback."""

from __future__ import annotations

import dataclasses
import random
from collections import Counter
from functools import partial
from pathlib import Path

import pytest

from jfto_mavlink.errors import MissionError, MissionFileError
from jfto_mavlink.files import read_mission, write_mission
from jfto_mavlink.mission.build import build_missions
from jfto_mavlink.mission.fence import Circle, Fence, Polygon, RallyPoint
from jfto_mavlink.mission.limits import MissionLimits, check_limits
from jfto_mavlink.mission.settings import settings_for
from jfto_mavlink.protocol.item import Mission
from jfto_msgs_py.errors import WaypointError
from jfto_msgs_py.mission_file import FORMATS, GeoPlan, GeoRoute, GeoStop
from jfto_msgs_py.mission_file.safe_xml import members
from jfto_msgs_py.text_encoding import read_foreign_text
from jfto_planner.coverage import Assumed, read_waypoint_set
from jfto_world.terrain import load_dem
from support.mutated_missions import count_held, mutated

CASES = Path(__file__).parents[2] / "data/cases"
FENCE = Fence(
    (Polygon(((46.19, 7.59), (46.21, 7.59), (46.21, 7.61))),),
    (Circle((46.2, 7.6), 30.0, inclusion=False),),
    (46.2, 7.6),
)
RALLY = (RallyPoint((46.2, 7.6), 30.0),)
_HOME = (46.2, 7.6, 1500.0)
_STOPS = tuple(
    GeoStop(k, (46.2 + 2e-4 * k, 7.6, 1600.0), 40.0 * k, -90.0 + 10 * k) for k in range(4)
)
_ROUTE = GeoPlan("mutated", (GeoRoute("uav1", _STOPS, _HOME),))


@pytest.fixture(scope="module")
def sources(tiny_run, tmp_path_factory):
    """Other people's files, and our own with fence and rally points."""
    folder = tmp_path_factory.mktemp("own")
    plan = tiny_run[1].plan
    own = build_missions(plan, settings_for(plan), FENCE, RALLY)[0].mission
    write_mission(folder / "own.plan", own)
    joined = dataclasses.replace(own, items=(*own.items, *own.fence, *own.rally))
    write_mission(folder / "own.waypoints", Mission(joined.items))
    paths = [*CASES.glob("0*.plan"), *CASES.glob("0*.waypoints"), *folder.iterdir()]
    return [(path.suffix, path.read_bytes()) for path in sorted(paths)]


@pytest.fixture(scope="module")
def dem():
    return load_dem(CASES / "00-ground.tif", center=(46.2, 7.6), size_m=(400.0, 400.0))


def try_one(path, dem):
    """What became of a file, as a mission and as waypoints."""
    mission, told = outcome(lambda: read_mission(path), MissionFileError)
    assert mission or str(path) in told
    as_mission = "refused"
    if mission:
        text, _ = read_foreign_text(path, "mission", 2**20)
        found = len(mission.items[1:]) + len(mission.fence) + len(mission.rally)
        assert found == count_held(path, text)
        converted(mission, path)
        limits = MissionLimits()
        _, told = outcome(lambda: check_limits(str(path), mission.items, limits), MissionError)
        as_mission = "out of limits" if told else "read"
    given, told = outcome(lambda: read_waypoint_set(path, dem), WaypointError)
    assert given or str(path) in told
    if not given:
        return as_mission, "refused"
    laid_out = any("photo positions laid out" in note for note in given.notes)
    if mission and not laid_out:
        assert len(given.waypoints) == sum(i.command in (16, 82) for i in mission.items[1:])
    return as_mission, "photos" if laid_out else "read"


def outcome(attempt, refusal):
    """Result, or None and the words of the one error that is allowed."""
    try:
        return attempt(), ""
    except refusal as error:
        return None, str(error)


def converted(mission, path):
    """In the other format it is the same, or refused by name."""
    other = path.with_name("converted" + (".waypoints" if path.suffix == ".plan" else ".plan"))
    for beside in path.parent.glob("converted*"):
        beside.unlink()
    written, _ = outcome(lambda: write_mission(other, mission), (MissionError, MissionFileError))
    if not written:
        return
    back = read_mission(other)
    assert [_core(item) for item in back.items] == [_core(item) for item in mission.items]
    # A .plan lists polygons, circles and the return point, each by themselves.
    fences = [sorted((i.command, i.x, i.y) for i in m.fence) for m in (back, mission)]
    assert fences[0] == fences[1]
    assert [(i.command, i.x, i.y, i.z) for i in back.rally] == [
        (i.command, i.x, i.y, i.z) for i in mission.rally
    ]


def _core(item):
    """An item but for `current`, which a .plan does not have, with text for what is no number."""
    return (item.command, item.frame, *map(repr, item.params), item.x, item.y, repr(item.z))


def run(count, seed, sources, dem, folder):
    rng = random.Random(seed)
    outcomes = Counter()
    for number in range(count):
        suffix, content = sources[rng.randrange(len(sources))]
        path = folder / f"m{suffix}"
        path.write_bytes(mutated(content, suffix, rng))
        try:
            outcomes[try_one(path, dem)] += 1
        except Exception as error:
            error.add_note(f"file {number} of seed {seed}: {path.read_bytes()[:3000]!r}")
            raise
    return outcomes


def test_mutated_files_are_read_whole_or_refused(sources, dem, tmp_path):
    """300 of them: items, fence and rally points that are in come out, or the file is refused."""
    outcomes = run(300, 1, sources, dem, tmp_path)
    assert sum(outcomes.values()) == 300
    # Neither is all refused, nor is all taken.
    assert outcomes["refused", "refused"] > 30
    assert sum(n for (mission, _), n in outcomes.items() if mission == "read") > 30, outcomes
    assert sum(n for (_, given), n in outcomes.items() if given != "refused") > 15, outcomes


def run_tables(count, seed, dem, folder):
    """Mutated tables, points and routes of every format that is written: how many are read."""
    rng = random.Random(seed)
    table = "lat\tlon,alt,heading\n46.2,7.6,1580,90\n46.2001,7.6,1580,10\n".replace("\t", ",")
    sources = [(".geojson", path.read_bytes()) for path in sorted(CASES.glob("*.geojson"))]
    sources.append((".csv", table.encode()))
    sources += [(form.suffixes[0], form.write(_ROUTE)) for form in FORMATS if form.write]
    packed = next(data for name, data in sources if name == ".kmz" and b"wpmz" in data)
    sources.append((".wpml", members(packed, "w.kmz")["wpmz/waylines.wpml"]))
    read = 0
    for number in range(count):
        suffix, content = sources[rng.randrange(len(sources))]
        path = folder / f"w{suffix}"
        path.write_bytes(mutated(content, suffix, rng))
        try:
            assumed = Assumed((46.2, 7.6), 50.0)
            given, told = outcome(partial(read_waypoint_set, path, dem, assumed), WaypointError)
        except Exception as error:
            error.add_note(f"file {number} of seed {seed}: {path.read_bytes()[:3000]!r}")
            raise
        assert given or str(path) in told
        read += given is not None
    return read


def test_mutated_tables_and_points(dem, tmp_path):
    """1000 tables, points, KML, waylines and archives: read or refused by name."""
    assert 30 < run_tables(1000, 1, dem, tmp_path) < 970


@pytest.mark.slow
def test_ten_thousand_mutated_files(sources, dem, tmp_path):
    """The same of 10 000, with the counts printed."""
    outcomes = run(10_000, 14, sources, dem, tmp_path)
    assert sum(outcomes.values()) == 10_000
    print(dict(outcomes), run_tables(10_000, 14, dem, tmp_path), "tables read")
