"""Plans on disk."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from jfto_msgs_py.errors import InputError, PlanError
from jfto_msgs_py.plan_file import plan_of_text, plan_text, read_plan, rounded, write_plan
from jfto_msgs_py.records.certificate import Certificate, Violation
from jfto_msgs_py.records.plan import Origin, Plan, Route, Slots, Uav, Waypoint
from jfto_msgs_py.records.radio import Radio
from jfto_msgs_py.records.site import Fence, Polygon, Sortie, Zone
from jfto_msgs_py.records.way_home import WayHome


def _plan(scale: float = 1.0) -> Plan:
    uavs = tuple(
        Uav(f"uav{n}", 27.0 + n, 150.0, 400.0, 10.0, 4.0, 3.0, (20.0 * n, 0.0, 1.5)) for n in (1, 2)
    )
    waypoints = tuple(Waypoint(n, (n * scale, -n * scale, 7.0 / 3.0), 10.0 * n) for n in range(3))
    violation = Violation("neighbours", "uav1", 3.5, None, 1.0, 2.0, "uav1 has 1 neighbour.")
    certificate = Certificate(False, 6, 1, 1, math.inf, "uav1", 3.5, 20.0, (1.0, 2.0), (violation,))
    return Plan(
        scenario_hash="ab" * 32,
        seed=3,
        origin=Origin(36.629200001, -84.2625, 673.7),
        radio=Radio(),
        k_min=1,
        delta=2,
        d_min_m=10.0,
        length_max_m=1e4,
        slots=Slots(2, 7.0 / 3.0),
        waypoints=waypoints,
        uavs=uavs,
        routes=(Route((2, 0), (1.0, 2.5), 30.0), Route((1,), (4.0,), 12.0)),
        positions_m=np.arange(18, dtype=float).reshape(2, 3, 3) * scale / 7.0,
        certificate=certificate,
    )


def test_a_plan_comes_back_from_its_file(tmp_path: Path) -> None:
    """Reading what was written gives the rounded plan, and writing that the same bytes."""
    plan = rounded(_plan())
    path = tmp_path / "plan.json"
    write_plan(plan, path)
    back = read_plan(path)
    assert plan_text(back) == plan_text(plan) == path.read_text()
    assert back.routes == plan.routes
    assert back.uavs == plan.uavs
    np.testing.assert_array_equal(back.positions_m, plan.positions_m)
    assert [entry.name for entry in tmp_path.iterdir()] == ["plan.json"]


def test_the_file_has_the_agreed_keys() -> None:
    """Other programs find every agreed key, and plain JSON numbers only."""
    found = json.loads(plan_text(_plan()))
    assert found["format"] == "jfto-plan"
    assert found["version"] == 3
    assert set(found["origin"]) == {"lat", "lon", "alt_m"}
    assert set(found["slots"]) == {"count", "duration_s"}
    assert set(found["waypoints"][0]) == {"id", "position_m", "yaw_deg", "pitch_deg", "photo"}
    assert set(found["uavs"][0]) >= {
        *("id", "p_max_dbm", "energy_j", "t_max_s", "speed_mps"),
        *("start_m", "route", "arrival_s", "length_m"),
    }
    assert np.shape(found["positions_m"]) == (2, 3, 3)
    assert found["certificate"]["worst_margin_db"] is None


@settings(deadline=None, max_examples=60, derandomize=True)
@given(st.floats(-1e6, 1e6))
def test_rounding_is_done_once(scale: float) -> None:
    """A rounded plan is its own rounding, and no position moves by more than half a micrometre."""
    plan = _plan(scale)
    once = rounded(plan)
    assert plan_text(rounded(once)) == plan_text(once)
    assert np.abs(once.positions_m - plan.positions_m).max() <= 5.1e-7


def test_minus_zero_is_zero() -> None:
    """Two plans that differ in the sign of a zero are the same file."""
    plan = _plan()
    positions = plan.positions_m.copy()
    positions[0, 0, 0] = -0.0
    assert plan_text(replace(plan, positions_m=positions)) == plan_text(plan)


@settings(deadline=None, max_examples=200, derandomize=True)
@given(st.data())
def test_any_damage_is_a_plan_error(data: st.DataObject) -> None:
    """A plan with any value replaced by another is read or refused with a PlanError."""
    plan = json.loads(plan_text(rounded(_plan())))
    place, key = plan, data.draw(st.sampled_from(sorted(plan)))
    while isinstance(place[key], dict | list) and place[key] and data.draw(st.booleans()):
        place = place[key]
        keys = sorted(place) if isinstance(place, dict) else range(len(place))
        key = data.draw(st.sampled_from(list(keys)))
    place[key] = data.draw(
        st.none() | st.booleans() | st.integers() | st.text(max_size=3) | st.just([]) | st.just({})
    )
    said = "damaged.json"
    try:
        plan_of_text(json.dumps(plan), Path("damaged.json"))
    except PlanError as error:
        said = str(error)
    assert "damaged.json" in said


def test_a_place_that_cannot_be_written_is_named(tmp_path: Path) -> None:
    """Writing below a file fails with the path and what to do."""
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match=r"file.*--out"):
        write_plan(_plan(), tmp_path / "file" / "plan.json")


def test_every_key_of_the_file_is_in_the_reference() -> None:
    """docs/reference/plan.md names each member of the file and of its waypoints and UAVs."""
    page = (Path(__file__).parents[2] / "docs/reference/plan.md").read_text()
    found = json.loads(plan_text(_plan()))
    for part in (found, found["waypoints"][0], found["uavs"][0], found["slots"], found["sortie"]):
        assert [name for name in part if f"`{name}`" not in page and f".{name}`" not in page] == []


@pytest.mark.parametrize("version", [1, 2])
def test_a_plan_of_an_older_version_is_read_without_what_it_did_not_know(version: int) -> None:
    """No site before version 3, no way home, endurance or wind in 1; it is written as version 3."""
    document = json.loads(plan_text(_plan()))
    document["version"] = version
    for name in (
        "area",
        "fence",
        "ground_stations",
        "sortie",
        "topology",
        *(["wind_mps"] if version == 1 else []),
    ):
        del document[name]
    for waypoint in document["waypoints"]:
        del waypoint["photo"]
    for uav in document["uavs"] if version == 1 else []:
        del uav["home"], uav["endurance_s"]
    plan = plan_of_text(json.dumps(document), Path("old.json"))
    assert (plan.homes, plan.landed_s, plan.wind_mps) == ((), None, 0.0)
    assert (plan.area, plan.fence, plan.sortie) == ((), None, Sortie(1, 1))
    assert plan.topology == "literal"
    assert all(waypoint.photo for waypoint in plan.waypoints)
    assert json.loads(plan_text(plan))["version"] == 3
    document["version"] = 4
    with pytest.raises(PlanError, match="version is 4, this program reads 1 and 2 and 3"):
        plan_of_text(json.dumps(document), Path("newer.json"))


_SQUARE = ((0.0, 0.0), (9.0, 0.0), (9.0, 9.0), (0.0, 9.0))


def test_the_site_comes_back_from_its_file() -> None:
    """Area with a hole, fence with a ring and a circle, the sortie, a waypoint without photo."""
    hole = ((2.0, 2.0), (3.0, 2.0), (3.0, 3.0))
    fence = Fence(
        (Polygon(_SQUARE),),
        (Zone("mast", (), (4.0, 5.0), 2.5, None, 80.0), Zone("house", _SQUARE)),
        5.0,
    )
    plan = _plan()
    passed = replace(plan.waypoints[0], photo=False)
    plan = replace(
        plan,
        area=(Polygon(_SQUARE, (hole,)),),
        fence=fence,
        sortie=Sortie(2, 3),
        waypoints=(passed, *plan.waypoints[1:]),
    )
    back = plan_of_text(plan_text(plan), Path("plan.json"))
    assert (back.area, back.fence, back.sortie) == (plan.area, plan.fence, plan.sortie)
    assert [waypoint.photo for waypoint in back.waypoints] == [False, True, True]


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"sortie": Sortie(3, 2)}, "sortie.number is 3 of 2"),
        ({"area": (Polygon(((0.0, 0.0), (1.0, 1.0))),)}, "area\\[0\\] has a ring of 2 corners"),
        ({"fence": Fence(keep_out=(Zone("mast"),))}, "either a ring of 3 corners or more or a"),
        ({"fence": Fence(keep_out=(Zone("hut", _SQUARE, radius_m=1.0),))}, "either a ring"),
        ({"fence": Fence(keep_out=(Zone("hut", _SQUARE, (0.0, 0.0), 0.0, 9.0, 8.0),))}, "below"),
    ],
)
def test_an_impossible_site_is_refused(change: dict[str, Any], said: str) -> None:
    """Each contradiction names the member and what to do."""
    with pytest.raises(PlanError, match=said):
        plan_of_text(plan_text(replace(_plan(), **change)), Path("plan.json"))


def test_a_way_home_comes_back_from_its_file() -> None:
    """All or none have one, and its times do not run backwards."""
    home = WayHome(3.0, ((1.0, 2.0, 3.0), (0.0, 0.0, 11.5)), (7.0, 9.0), 31.0)
    plan = rounded(replace(_plan(), homes=(home, home), wind_mps=3.0))
    assert plan.homes == (home, home)
    assert (plan.landed_s, plan.wind_mps) == (31.0, 3.0)
    document = json.loads(plan_text(plan))
    document["uavs"][1]["home"]["landed_s"] = 8.0
    with pytest.raises(PlanError, match=r"uavs\[1\].home: its times run backwards"):
        plan_of_text(json.dumps(document), Path("plan"))
    document["uavs"][1]["home"] = None
    with pytest.raises(PlanError, match="either all UAVs have a way home or none"):
        plan_of_text(json.dumps(document), Path("plan"))
