"""jfto up: the real graph in processes of its own."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from std_msgs.msg import Float64MultiArray
from trajectory_msgs.msg import MultiDOFJointTrajectory

from jfto_msgs_py.ros import qos, topics
from jfto_msgs_py.ros.network import decode_power_schedule
from support.graph import Graph

LIMIT_S = 60.0


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


def _end(process: subprocess.Popen, number: int) -> tuple[int, str]:
    process.send_signal(number)
    output, _ = process.communicate(timeout=LIMIT_S)
    return process.returncode, output


def test_the_graph_heals_after_kill_and_ends_with_ctrl_c(tiny, tmp_path) -> None:
    """Planned, flown by a pose player; power node killed: the account and the schedule go on."""
    with Graph() as graph:
        process = _up(
            graph.context.get_domain_id(), tiny, tmp_path, "--poses", "plan", "--start-delay", "0",
            "--set", "fleet.speed_mps=15",
        )  # fmt: skip
        try:
            schedules = graph.collect(Float64MultiArray, topics.POWER_SCHEDULE, qos.latched())
            graph.until(lambda: schedules)
            state = json.loads((tmp_path / "status.json").read_text())
            os.kill(state["power_node"]["pid"], signal.SIGKILL)
            os.kill(state["planner_node"]["pid"], signal.SIGKILL)
            before = len(schedules)
            graph.until(lambda: len(schedules) > before)
            late = graph.collect(MultiDOFJointTrajectory, topics.trajectory("uav1"), qos.latched())
            graph.until(lambda: late)
        finally:
            status, output = _end(process, signal.SIGINT)
    first, last = (decode_power_schedule(schedules[i]).horizon for i in (0, -1))
    assert last.t0_ns - first.t0_ns == round((last.first - first.first) * first.duration_s * 1e9)
    assert status == 0, output
    assert "killed by SIGKILL" in output
    assert [line.split()[1] for line in output.splitlines() if line.endswith(" stopped")] == [
        "pose_player", "power_node", "topology_node", "planner_node",
    ]  # fmt: skip


def test_nodes_end_with_a_killed_supervisor(tiny, tmp_path) -> None:
    """Killed with -9 it leaves no node behind."""
    process = _up(5, tiny, tmp_path)
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


def test_a_node_with_bad_parameters_ends_the_graph(tiny, tmp_path) -> None:
    """The status tells which node was given up, and its last words are shown."""
    (tmp_path / "energy.json").write_text("{}")
    process = _up(3, tiny, tmp_path)
    output, _ = process.communicate(timeout=LIMIT_S)
    assert process.returncode == 12, output
    assert "is no energy account" in output


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_node_ends_cleanly_on_a_signal(tmp_path, number) -> None:
    """Status 0, and nothing on its output but what it logged."""
    source = Path(__file__).parents[3] / "src"
    process = subprocess.Popen(
        [sys.executable, "-m", "jfto.nodes", "topology_node"],
        env={**os.environ, "PYTHONPATH": str(source), "ROS_DOMAIN_ID": "4"},
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
