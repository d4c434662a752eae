"""jfto fly with simulated vehicles."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from jfto.cli import main
from jfto_mavlink.files.tlog import read_tlog
from jfto_msgs_py.plan import Origin, Plan, Route, Slots, Uav, Waypoint
from jfto_msgs_py.plan_file import write_plan
from jfto_msgs_py.radio import Radio


@pytest.fixture
def plan(tmp_path: Path) -> Path:
    """Three UAVs, one or two waypoints close by each, at the foot of nothing."""
    waypoints = tuple(Waypoint(k, (15.0 + k, 12.0 * k, 11.0)) for k in range(1, 6))
    uavs = tuple(
        Uav(f"uav{k}", 30.0, 200.0, 450.0, 8.0, 2.5, 1.5, (0.0, 20.0 * k, 0.0)) for k in (1, 2, 3)
    )
    routes = (
        Route((1, 2), (9.0, 15.0), 30.0),
        Route((3, 4), (9.0, 15.0), 30.0),
        Route((5,), (9.0,), 18.0),
    )
    path = tmp_path / "plan.json"
    write_plan(
        Plan("0" * 64, 1, Origin(47.4, 8.5, 488.0), Radio(), 1, 1, 5.0, 1000.0, Slots(10, 1.5),
             waypoints, uavs, routes, np.zeros((3, 11, 3))),
        path,
    )  # fmt: skip
    return path


def test_a_plan_is_flown_to_the_end(plan, tmp_path, capsys):
    """Every waypoint within 2 m, all landed, a log per vehicle and a record of the flight."""
    out = tmp_path / "flight"
    arguments = ["fly", str(plan), "--vehicles", "sim:3", "--speedup", "15", "-o", str(out)]
    assert main(arguments) == 0
    screen = capsys.readouterr().out
    assert screen.count("✓ uav") == 3
    flight = json.loads((out / "flight.json").read_text())
    passages = [w for v in flight["vehicles"].values() for w in v["waypoints"]]
    assert len(passages) == 5
    assert all(w["closest_m"] <= 2.0 for w in passages)
    assert {v["ended"] for v in flight["vehicles"].values()} == {"landed"}
    assert {e["kind"] for e in flight["events"]} >= {"armed", "mode", "landed"}
    for uav in flight["vehicles"]:
        assert len(list(read_tlog(out / f"{uav}.tlog"))) > 500


def test_a_plan_that_cannot_be_flown_is_refused_before_anything_starts(plan, tmp_path, capsys):
    """A mission too far from home, by the limit given."""
    out = tmp_path / "flight"
    arguments = ["fly", str(plan), "--vehicles", "sim:3", "--distance-max", "10", "-o", str(out)]
    assert main(arguments) == 2
    assert "m from home, at most 10 m" in capsys.readouterr().err
    assert not out.exists()


def test_a_missing_plan_is_said_to_be_missing(tmp_path, capsys):
    """Status 2, no traceback."""
    assert main(["fly", str(tmp_path / "none.json"), "--vehicles", "sim:3"]) == 2
    assert "none.json" in capsys.readouterr().err


def test_gates_need_times_that_vehicles_can_keep(plan, capsys):
    """Constant-speed times are too early: a late vehicle would wait a minute at its gate."""
    assert main(["fly", str(plan), "--vehicles", "sim:3", "--gate", "1"]) == 2
    assert "plan with the arducopter time model" in capsys.readouterr().err
