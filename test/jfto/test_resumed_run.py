"""A `jfto run` that is killed in mid-flight, and another that takes the flight over."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path

import pytest

from jfto.planning.routes import plan_routes
from jfto.planning.scenario_file import load_scenario
from jfto.planning.survey import survey
from jfto.simulation.fleet import vehicle_configs
from jfto.supervision.graph_table import FLIGHT_STATE_NAME
from jfto_mavlink.fleet.monitor import FlightState
from jfto_mavlink.fleet.watched_flight import write_flight_state
from jfto_msgs_py.plan_file import write_plan
from support.vehicles import Vehicles

ROOT = Path(__file__).parents[2]
SCENE = ROOT / "test" / "data" / "scenario" / "short_flight.yaml"
LIMIT_S = 400.0
# The vehicles' time passes so much faster than the run knows, to which they are real; while nobody
# follows them it passes as it is, so that there is something left to follow on a busy computer.
SPEEDUP = 6
JFTO = [sys.executable, "-m", "jfto"]


def until(condition: Callable[[], bool]) -> None:
    """Wait for what is expected."""
    end_s, tick = time.monotonic() + LIMIT_S, threading.Event()
    while not condition():
        assert time.monotonic() < end_s, "it did not happen"
        tick.wait(0.1)


def pace(fleet: Vehicles, speedup: float) -> None:
    """Let the time of simulated vehicles pass so fast."""
    if fleet.server is not None:
        for station in fleet.server.stations.values():
            fleet.server.call(partial(station.vehicle.params.store, "SIM_SPEEDUP", speedup))


def taken_over(directory: Path) -> bool:
    """Whether a second bridge hears the vehicles and a second recorder records them."""
    said = (directory / "logs" / "mavlink_bridge.log").read_text()
    return (directory / "bag-2").exists() and said.count("uav1: heard") > 1


def lifted_off(directory: Path) -> bool:
    """Whether the bridge has written down a lift-off a while ago."""
    path = directory / "flight_state.json"
    if not path.exists():
        return False
    lift_off_ns = json.loads(path.read_text())["lift_off_ns"]
    return lift_off_ns is not None and time.time() - lift_off_ns / 1e9 > 1.5


@pytest.mark.slow(40)
def test_a_flight_whose_run_was_killed_is_taken_over(vehicles, tmp_path: Path) -> None:
    """Kill -9 takes the nodes along, vehicles fly on; --resume follows them down and reports."""
    planned, directory = tmp_path / "plan.json", tmp_path / "run"
    loaded = load_scenario(SCENE)
    plan = plan_routes(loaded.scenario, survey(loaded)).plan
    write_plan(plan, planned)
    fleet = vehicles(vehicle_configs(plan, time.time_ns()), speedup=SPEEDUP)
    run = [*JFTO, "run", str(SCENE), "--plan", str(planned), "-o", str(directory)]
    run += ["--vehicles", fleet.text, "--arm"]
    with (tmp_path / "killed.txt").open("w") as said:
        flight = subprocess.Popen(run, stdout=said, stderr=said)
        try:
            until(lambda: flight.poll() is not None or lifted_off(directory))
            assert flight.poll() is None, (tmp_path / "killed.txt").read_text()
        finally:
            pace(fleet, 1.0)
            os.kill(flight.pid, signal.SIGKILL)
            flight.wait()
    resumed = [*JFTO, "run", "--resume", str(directory), "--json"]
    with subprocess.Popen(
        resumed, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as again:
        try:
            until(lambda: again.poll() is not None or taken_over(directory))
            pace(fleet, SPEEDUP)
            said, complaints = again.communicate(timeout=LIMIT_S)
        finally:
            again.kill()
    assert again.returncode in {0, 1}, said[-2000:] + complaints[-2000:]
    facts = json.loads(said)["flight"]
    assert facts["ended"] == "landed"
    told = json.loads((directory / "flight.json").read_text())
    assert any("The flight is taken over" in one["text"] for one in told["events"])
    assert told["waypoints"]["visited"] > 0


@pytest.mark.slow
def test_there_must_be_something_to_resume(tmp_path: Path, tiny: Path, capsys) -> None:
    """Another directory, or one whose vehicles ended with the run: said, with what can be done."""
    from jfto.cli.main import main

    assert main(["run", str(tiny), "--until", "plan", "-o", str(tmp_path / "plan")]) == 0
    assert main(["run", "--resume", str(tmp_path / "plan")]) == 2
    assert "no flight was begun there" in capsys.readouterr().err
    job = {"format": "jfto-flight-job", "version": 1, "title": "tiny", "simulated": True}
    job |= {"speedup": 1.0, "nodes": []}
    (tmp_path / "plan" / "flight_job.json").write_text(json.dumps(job))
    assert main(["run", "--resume", str(tmp_path / "plan")]) == 2
    assert "jfto report" in capsys.readouterr().err
    write_flight_state(
        FlightState({}, 1, {"uav1": "landed"}, over=True), tmp_path / "plan" / FLIGHT_STATE_NAME
    )
    assert main(["run", "--resume", str(tmp_path / "plan")]) == 2
    said = capsys.readouterr().err
    assert "its flight is over" in said
    assert "ended with their graph" not in said
