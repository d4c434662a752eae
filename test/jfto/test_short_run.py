"""The whole job in short: three UAVs planned, flown at ten times real time, recorded, judged.

On a computer that has no time to spare: other programs take all cores, and a node stands still for
seconds. The vehicles' time waits, so what is flown is the same.
"""

from __future__ import annotations

import json
import math
import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

from jfto.bag.reader import Bag
from jfto.bag.replay import replay_bag
from jfto_msgs_py.ros import topics
from support.domains import next_domain

ROOT = Path(__file__).parents[2]
pytestmark = pytest.mark.slow(10)
SCENE = ROOT / "test" / "data" / "scenario" / "short_flight.yaml"
# A minute on an idle computer; one that runs many tests at once takes several.
LIMIT_S = 900.0


# Longer than the vehicles' time may be ahead of a node, and shorter than it is waited for.
STOPPED_S = 3.0


@contextmanager
def busy_computer() -> Iterator[None]:
    """Two programs that do nothing but take time."""
    programs = [subprocess.Popen([sys.executable, "-c", "while True: pass"]) for _ in range(2)]
    try:
        yield
    finally:
        for program in programs:
            program.kill()
            program.wait()


def flies(directory: Path) -> bool:
    """Whether powers are in force that were solved a while after lift-off."""
    state, energy = directory / "flight_state.json", directory / "energy.json"
    if not (state.exists() and energy.exists()):
        return False
    lift_off_ns = json.loads(state.read_text())["lift_off_ns"] or math.inf
    return json.loads(energy.read_text())["at_ns"] > lift_off_ns + 5e9


def pid_of(name: str, directory: Path) -> int | None:
    """Of a node's process; None before it is started and once it has ended."""
    file = directory / "status.json"
    return json.loads(file.read_text())[name]["pid"] if file.exists() else None


def wait_in(flight: subprocess.Popen, condition: Callable[[], Any]) -> None:
    """Wait for what comes in the course of a run; fails where that ends before."""
    tick, end_s = threading.Event(), time.monotonic() + LIMIT_S
    while not condition():
        assert flight.poll() is None
        assert time.monotonic() < end_s
        tick.wait(0.2)


def stop_for_a_while(name: str, directory: Path) -> None:
    """Let a node's process stand still."""
    pid = pid_of(name, directory)
    assert pid is not None
    os.kill(pid, signal.SIGSTOP)
    threading.Event().wait(STOPPED_S)
    os.kill(pid, signal.SIGCONT)


@pytest.fixture(scope="module")
def flown(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, dict[str, Any]]:
    """Directory and printed facts of one run of the short scene."""
    directory = tmp_path_factory.mktemp("short") / "run"
    command = [sys.executable, "-m", "jfto", "run", str(SCENE), "-o", str(directory), "--json"]
    environment = {
        **os.environ,
        "PYTHONPATH": str(ROOT / "src"),
        "ROS_DOMAIN_ID": str(next_domain()),
        "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST",
    }
    flight = subprocess.Popen(
        [*command, "--speedup", "10"],
        env=environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    try:
        wait_in(flight, lambda: pid_of("planner_node", directory))
        # While the graph is up: before there is a plan and after the flight nothing waits for time.
        with busy_computer():
            wait_in(flight, lambda: flies(directory))
            stop_for_a_while("topology_node", directory)
            wait_in(flight, lambda: pid_of("planner_node", directory) is None)
        stdout, stderr = flight.communicate(timeout=LIMIT_S)
    finally:
        flight.kill()
    assert flight.returncode == 0, stdout[-2000:] + stderr[-2000:]
    return directory, json.loads(stdout)


def test_a_busy_computer_makes_it_slower_and_nothing_else(flown) -> None:
    """No pose is stale, no slot is late and no node is in trouble; how fast it was is said."""
    directory, facts = flown
    flight = json.loads((directory / "flight.json").read_text())
    assert [one for one in flight["events"] if one["level"] >= 30] == []
    # At lift-off the plan is published anew, a trajectory after the other, and time waits for it.
    assert [one for one in flight["troubles"] if one["to_s"] > 1.0] == []
    (told,) = [one["text"] for one in flight["events"] if one["kind"] == "pace"]
    assert "of 10 asked; it waited for" in told
    assert "topology_node" in told
    assert facts["flight"]["speedup"] < 9.5


def test_the_run_ends_well_with_everything_in_its_directory(flown) -> None:
    """Landed by itself, no process died, and plan, bag, logs, facts and report are there."""
    directory, facts = flown
    assert facts["flight"]["ended"] == "landed"
    assert facts["flight"]["good"]
    assert facts["flight"]["processes_died"] == []
    names = {path.name for path in directory.iterdir()}
    assert names >= {"scenario.yaml", "plan.json", "bag", "flight.json", "report.html", "log.txt"}
    assert "preflight.json" in names
    assert "parameters.json" not in names, "it is gone once all parameters are put back"
    assert {path.name for path in (directory / "tlogs").iterdir()} == {
        "uav1.tlog",
        "uav2.tlog",
        "uav3.tlog",
    }


def test_what_was_flown_keeps_the_plan(flown) -> None:
    """All waypoints on time, clean slots, no energy overdrawn, throughput, everybody's end."""
    directory, _ = flown
    flight = json.loads((directory / "flight.json").read_text())
    assert flight["waypoints"]["visited"] == flight["waypoints"]["count"] == 6
    assert abs(flight["waypoints"]["worst_late_s"]) <= 0.5
    assert flight["certificate"]["clean_share"] >= 0.99
    assert all(one["used_j"] <= one["budget_j"] for one in flight["energy"])
    assert flight["network"]["throughput_mbps"]["ratio"] >= 0.95
    assert {one["how"] for one in flight["endings"]} == {"landed"}
    last = [one["text"] for one in flight["events"] if one["kind"] == "landed" and not one["uav"]]
    assert len(last) == 1
    assert last[0].startswith("The flight is over: uav1 landed on its pad;")


def test_the_bag_replays_to_the_same_topology_and_powers(flown) -> None:
    """The recorded poses through the real nodes again: links equal, powers within 0.25 dB.

    Where slots begin depends on the order in which poses and the clock came: 30 ms are a quarter
    of a metre, which a link of 10 m feels by 0.2 dB; one slot in ten may differ.
    """
    bag = flown[0] / "bag"
    replay = replay_bag(Bag(bag), ["topology", "power"], bag / "parameters.yaml", 0.25)
    by_topic = {each.topic: each for each in replay.comparisons}
    for topic in (topics.ADJACENCY, topics.POWER_INTERVAL, topics.POWER_SCHEDULE):
        assert by_topic[topic].compared >= 12
        allowed = 0.1 * by_topic[topic].compared
        assert len(by_topic[topic].problems) <= allowed, by_topic[topic].problems
