"""Guided flights through `jfto run`: three UAVs on streamed curves, to the end whatever dies."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path
from typing import Any

import pytest

from jfto.planning.routes import plan_routes
from jfto.planning.scenario_file import load_scenario
from jfto.planning.survey import survey
from jfto_msgs_py.plan_file import write_plan

ROOT = Path(__file__).parents[2]
SCENE = ROOT / "test" / "data" / "scenario" / "short_flight.yaml"
# Half a minute on an idle computer; one that runs many tests at once takes several.
LIMIT_S = 600.0
SPEEDUP = "8"
GUIDED = "trajectory.mode=guided"
# Targets, and what is told of positions, are late by so many times what a busy computer takes.
LATENESS_S = 8 * 0.75
# How late a bridge may make a fleet that is killed and started again, s of the vehicles' time.
RESTARTED_S = 60.0


def along_s(directory: Path) -> float:
    """How far along its curves the fleet was told to be last."""
    path = directory / "guided_flight.json"
    return float(json.loads(path.read_text())["elapsed_s"]) if path.exists() else 0.0


@pytest.fixture(scope="module")
def planned(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The plan that all fly."""
    loaded = load_scenario(SCENE, [GUIDED])
    path = tmp_path_factory.mktemp("guided") / "plan.json"
    write_plan(plan_routes(loaded.scenario, survey(loaded)).plan, path)
    return path


def fly(planned: Path, directory: Path, killed: str = "") -> dict[str, Any]:
    """Facts printed by a guided run in which a node is killed in mid-flight."""
    command = [sys.executable, "-m", "jfto", "run", str(SCENE), "--set", GUIDED]
    command += ["--plan", str(planned), "--speedup", SPEEDUP, "-o", str(directory), "--json"]
    flight = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    end_s, tick = time.monotonic() + LIMIT_S, threading.Event()
    try:
        if killed:
            while along_s(directory) < 15.0:
                assert flight.poll() is None
                assert time.monotonic() < end_s
                tick.wait(0.05)
            pid = json.loads((directory / "status.json").read_text())[killed]["pid"]
            os.kill(pid, signal.SIGKILL)
        stdout, stderr = flight.communicate(timeout=LIMIT_S)
    finally:
        flight.kill()
    assert flight.returncode in {0, 1}, stdout[-2000:] + stderr[-2000:]
    return json.loads(stdout)


def flown_facts(directory: Path) -> dict[str, Any]:
    """What the report says of the flight."""
    return json.loads((directory / "flight.json").read_text())


@pytest.mark.slow(30)
def test_a_guided_run_is_flown_to_its_end(planned: Path, tmp_path: Path) -> None:
    """Curves are streamed, never missions; all waypoints in time, all home and disarmed."""
    facts = fly(planned, tmp_path / "run")
    assert facts["flight"]["ended"] == "landed"
    assert facts["flight"]["processes_died"] == []
    flight = flown_facts(tmp_path / "run")
    assert flight["waypoints"]["worst_closest_m"] < 4.0
    assert abs(flight["waypoints"]["worst_late_s"]) < LATENESS_S
    assert {one["how"] for one in flight["endings"]} == {"landed"}
    assert [one for one in flight["events"] if one["level"] >= 40] == []
    texts = [one["text"] for one in flight["events"]]
    assert "start: streaming: uav1, uav2, uav3" in texts


@pytest.mark.slow(30)
def test_a_planner_that_dies_changes_nothing(planned: Path, tmp_path: Path) -> None:
    """The bridge has the curves: the flight goes on, on time, and home."""
    facts = fly(planned, tmp_path / "run", "planner_node")
    assert facts["flight"]["ended"] == "landed"
    assert [one["name"] for one in facts["flight"]["processes_died"]] == ["planner_node"]
    flight = flown_facts(tmp_path / "run")
    assert flight["waypoints"]["worst_closest_m"] < 4.0
    assert abs(flight["waypoints"]["worst_late_s"]) < LATENESS_S


@pytest.mark.slow(30)
def test_a_bridge_that_dies_goes_on_with_the_flight(planned: Path, tmp_path: Path) -> None:
    """All stand, and go on from there together, later by what that took; it is told."""
    facts = fly(planned, tmp_path / "run", "mavlink_bridge")
    assert facts["flight"]["ended"] == "landed"
    flight = flown_facts(tmp_path / "run")
    assert flight["waypoints"]["worst_closest_m"] < 4.0
    assert 0.0 < flight["waypoints"]["worst_late_s"] < RESTARTED_S
    texts = [one["text"] for one in flight["events"]]
    assert any(text.startswith("The bridge was started again: the fleet goes on") for text in texts)
