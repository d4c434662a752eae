"""jfto up: the real graph in processes of its own."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from geometry_msgs.msg import PoseStamped
from rosgraph_msgs.msg import Clock
from std_msgs.msg import Float64MultiArray
from std_srvs.srv import Trigger
from trajectory_msgs.msg import MultiDOFJointTrajectory

from jfto.bag.reader import Bag
from jfto_msgs_py.ros import qos, topics
from jfto_msgs_py.ros.network import decode_power_schedule
from jfto_msgs_py.ros.stamps import decode_time
from jfto_msgs_py.ros.vehicle import decode_pose
from support.domains import next_domain
from support.graph import Graph

# Processes take long to start where other tests run beside them.
LIMIT_S = 300.0


def _up(domain: int, scenario: Path, out: Path, *options: str) -> subprocess.Popen:
    source = Path(__file__).parents[3] / "src"
    return subprocess.Popen(
        [sys.executable, "-m", "jfto", "up", str(scenario), "-o", str(out), *options],
        env={
            **os.environ,
            "PYTHONPATH": str(source),
            "ROS_DOMAIN_ID": str(domain),
            "NUMBA_NUM_THREADS": "1",
        },
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )


def _end(process: subprocess.Popen, *numbers: int) -> tuple[int, str]:
    for number in numbers:
        process.send_signal(number)
    output, _ = process.communicate(timeout=LIMIT_S)
    return process.returncode, output


@pytest.mark.slow(6)
def test_the_graph_heals_after_kill_and_ends_with_ctrl_c(tiny, tmp_path) -> None:
    """Planned, flown by a pose player; power node killed: the account and the schedule go on.

    A second Ctrl-C changes nothing: all are stopped in order, and cleanly.
    """
    with Graph() as graph:
        process = _up(
            graph.context.get_domain_id(), tiny, tmp_path, "--poses", "plan", "--start-delay", "0",
            "--set", "fleet.speed_mps=15",
        )  # fmt: skip
        try:
            schedules = graph.collect(Float64MultiArray, topics.POWER_SCHEDULE, qos.latched())
            graph.until(lambda: schedules, LIMIT_S)
            state = json.loads((tmp_path / "status.json").read_text())
            os.kill(state["power_node"]["pid"], signal.SIGKILL)
            os.kill(state["planner_node"]["pid"], signal.SIGKILL)
            before = len(schedules)
            graph.until(lambda: len(schedules) > before, LIMIT_S)
            late = graph.collect(MultiDOFJointTrajectory, topics.trajectory("uav1"), qos.latched())
            graph.until(lambda: late, LIMIT_S)
        finally:
            status, output = _end(process, signal.SIGINT, signal.SIGINT)
    first, last = (decode_power_schedule(schedules[i]).horizon for i in (0, -1))
    # The power node is back within the slot, or in a later one; no slot comes twice.
    assert last.first >= first.first
    assert last.t0_ns >= first.t0_ns
    assert status == 0, output
    assert "killed by SIGKILL" in output
    assert [line.split()[1] for line in output.splitlines() if line.endswith(" stopped")] == [
        "pose_player", "power_node", "topology_node", "planner_node",
    ]  # fmt: skip


def _order(graph: Graph, process: subprocess.Popen, verb: str) -> str:
    """Give an order to the bridge until it says that it was carried out."""
    client = graph.observer.create_client(Trigger, f"/jfto/mission/{verb}")
    graph.until(lambda: client.service_is_ready() or process.poll() is not None, LIMIT_S)
    while process.poll() is None:
        future = client.call_async(Trigger.Request())
        graph.until(future.done, LIMIT_S)
        if future.result().success:
            return future.result().message
    return pytest.fail(process.communicate()[0])


@pytest.mark.slow(6)
def test_simulated_vehicles_fly_in_the_graph_and_are_recorded(tiny, tmp_path) -> None:
    """Orders by service; poses in the vehicles' own time, ten times the wall's; a whole bag."""
    with Graph() as graph:
        begun_ns = time.time_ns()
        process = _up(
            graph.context.get_domain_id(), tiny, tmp_path, "--vehicles", "sim:4", "--speedup", "10",
            "--record", "--start-delay", "0",
        )  # fmt: skip
        try:
            clock = graph.collect(Clock, topics.CLOCK, qos.clock())
            poses = graph.collect(PoseStamped, topics.pose("uav3"), qos.sensor())
            assert "4 missions on board" in _order(graph, process, "upload")
            assert _order(graph, process, "start") == "flying: uav1, uav2, uav3, uav4"
            first = decode_pose(poses[-1])
            graph.until(
                lambda: decode_pose(poses[-1]).position_m[2] > first.position_m[2] + 20, LIMIT_S
            )
            ran_ns = time.time_ns() - begun_ns
        finally:
            status, output = _end(process, signal.SIGTERM)
    assert status == 0, output
    stamps = [decode_pose(each).stamp_ns for each in poses]
    now_ns = decode_time(clock[-1].clock)
    # A busy computer stalls the vehicles now and then, and with them the clock.
    assert ran_ns < now_ns - begun_ns < 11 * ran_ns
    assert abs(now_ns - stamps[-1]) < 5e9
    # Stamped by the vehicles, four times a second of their own. Where a busy computer stalls them
    # one goes out late; stamps by the ticks of /clock, 200 ms apart, would be off every time.
    off_ns = (np.diff(stamps) + 125_000_000) % 250_000_000 - 125_000_000
    assert np.median(np.abs(off_ns)) <= 2e6
    facts = Bag(tmp_path / "bag").facts
    counts = {topic.name: topic.count for topic in facts.topics}
    assert facts.complete
    assert counts[topics.pose("uav3")] > 20
    assert {topics.ADJACENCY, topics.trajectory("uav1"), topics.DIAGNOSTICS} <= set(counts)
    assert topics.CLOCK not in counts
    assert (tmp_path / "tlogs" / "uav4.tlog").stat().st_size > 1000


@pytest.mark.slow(6)
def test_nodes_end_with_a_killed_supervisor(tiny, tmp_path) -> None:
    """Killed with -9 it leaves no node behind."""
    process = _up(next_domain(), tiny, tmp_path)
    end = time.monotonic() + LIMIT_S
    status = tmp_path / "status.json"
    while not status.exists():
        assert time.monotonic() < end
    pids = [node["pid"] for node in json.loads(status.read_text()).values()]
    for pid in pids:
        _await_handlers(pid)
    process.kill()
    process.communicate()
    while any(_is_running(pid) for pid in pids):
        assert time.monotonic() < end


def _is_running(pid: int) -> bool:
    try:
        stat = Path(f"/proc/{pid}/stat").read_text()
    except (FileNotFoundError, ProcessLookupError):
        return False
    return stat.rpartition(")")[2].split()[0] != "Z"


@pytest.mark.slow(6)
def test_a_node_with_bad_parameters_ends_the_graph(tiny, tmp_path) -> None:
    """The status tells which node was given up, and its last words are shown."""
    (tmp_path / "energy.json").write_text("{}")
    process = _up(next_domain(), tiny, tmp_path)
    output, _ = process.communicate(timeout=LIMIT_S)
    assert process.returncode == 12, output
    assert "is no energy account" in output


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_node_ends_cleanly_on_a_signal(tmp_path, number) -> None:
    """Status 0, and nothing on its output but what it logged."""
    source = Path(__file__).parents[3] / "src"
    process = subprocess.Popen(
        [sys.executable, "-m", "jfto.nodes", "topology_node"],
        env={**os.environ, "PYTHONPATH": str(source), "ROS_DOMAIN_ID": str(next_domain())},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )
    _await_handlers(process.pid)
    status, output = _end(process, number)
    assert (status, output) == (0, "")


def _await_handlers(pid: int) -> None:
    """Wait until the node handles signals: its status file lists them as caught."""
    end = time.monotonic() + LIMIT_S
    while time.monotonic() < end:
        lines = Path(f"/proc/{pid}/status").read_text().splitlines()
        caught = next(int(line.split()[1], 16) for line in lines if line.startswith("SigCgt"))
        if caught >> (signal.SIGTERM - 1) & 1:
            return
    pytest.fail("the node never took over SIGTERM")
