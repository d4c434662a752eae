"""A flight of real processes that loses a vehicle, and then its bridge."""

from __future__ import annotations

import json
import os
import signal
import socket
import subprocess
import sys
import time
from pathlib import Path

import pytest
from builtin_interfaces.msg import Time
from rcl_interfaces.msg import Log
from rclpy.serialization import deserialize_message

from jfto.bag.reader import Bag
from jfto_msgs_py.ros import qos, topics
from jfto_msgs_py.ros.events import decode_event
from support.graph import Graph

SHORT = Path(__file__).parents[1] / "data" / "scenario" / "short_flight.yaml"
# On a busy computer; a quiet one takes a minute.
LIMIT_S = 400.0


@pytest.fixture
def flight(tmp_path):
    """A run on its way, and its directory."""
    with Graph() as graph:
        out = tmp_path / "run"
        process = subprocess.Popen(
            [sys.executable, "-m", "jfto", "run", str(SHORT), "-o", str(out), "--speedup", "8"],
            env={
                **os.environ,
                "PYTHONPATH": os.pathsep.join(sys.path),
                "ROS_DOMAIN_ID": str(graph.context.get_domain_id()),
                "NUMBA_NUM_THREADS": "1",
            },
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
        )
        try:
            yield graph, process, out
        finally:
            process.kill()
            process.communicate()


def pid_of(out: Path, name: str) -> int:
    """A process of the run."""
    return json.loads((out / "status.json").read_text(encoding="utf-8"))[name]["pid"]


def fault(out: Path, line: str) -> None:
    """A fault line to the simulated fleet."""
    words = Path(f"/proc/{pid_of(out, 'simulated_fleet')}/cmdline").read_text().split("\0")
    (port,) = [int(word.partition(":=")[2]) for word in words if word.startswith("control_port:=")]
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
        sender.sendto(line.encode(), ("127.0.0.1", port))


def spin_until(graph, process, condition) -> None:
    """Listen until it holds, while the flight goes on."""
    end_s = time.monotonic() + LIMIT_S
    while not condition():
        assert process.poll() is None, process.communicate()[0]
        assert time.monotonic() < end_s, "it did not happen"
        graph.executor.spin_once(timeout_sec=0.05)


def test_a_flight_outlives_a_vehicle_and_its_bridge(flight) -> None:
    """The others fly on and land; each has an end, each fault its line, and the bag has it all."""
    graph, process, out = flight
    lift_offs = graph.collect(Time, topics.LIFT_OFF, qos.latched())
    heard = graph.collect(Log, topics.EVENTS, qos.events())
    spin_until(graph, process, lambda: lift_offs)
    fault(out, "kill 3")
    spin_until(
        graph, process, lambda: any((e.function, e.file) == ("vehicle", "uav3") for e in heard)
    )
    os.kill(pid_of(out, "mavlink_bridge"), signal.SIGKILL)
    output, _ = process.communicate(timeout=LIMIT_S)
    bag = Bag(out / "bag")
    events = [
        decode_event(deserialize_message(message.data, Log))
        for message in bag.messages([topics.EVENTS])
    ]
    assert bag.facts.complete, output
    assert all(decode_event(message) in events for message in heard)
    (lost, *_) = [e.text for e in events if (e.kind, e.uav_id) == ("vehicle", "uav3")]
    assert lost.startswith("uav3 is lost: not heard for"), output
    assert "uav1, uav2 fly on" in lost
    assert any(e.kind == "restart" and "mavlink_bridge killed by SIGKILL" in e.text for e in events)
    over = [e.text for e in events if (e.kind, e.uav_id) == ("landed", "")][-1]
    assert "uav1 landed on its pad; uav2 landed on its pad; uav3 declared lost" in over
