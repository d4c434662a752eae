"""Planner, topology and power on three hosts over a bad radio, each in a network namespace."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from contextlib import ExitStack
from pathlib import Path

import pytest

from jfto_msgs_py.plan_file import write_plan
from jfto_msgs_py.scenario import Given, make_scenario
from support import lossy_switch
from support.graph import SCENARIO as QUICK
from support.plans import side_by_side

# So slow that the mission outlasts any start: nobody plans for slots that are over.
SCENARIO = QUICK | {"fleet.speed_mps": [0.5]}
# Three processes must start, on a computer that may be busy.
LIMIT_S = 240.0
pytestmark = pytest.mark.slow
HOSTS = ("planner", "topology", "power")
DISCOVERY = "ROS_AUTOMATIC_DISCOVERY_RANGE"
# What the tests' own ROS set, and a process on another host would not inherit.
OF_OURS = (DISCOVERY, "FASTRTPS_DEFAULT_PROFILES_FILE")
# Runs on the third host too, as somebody who joins there and waits until the graph has all UAVs: a
# pose that the radio lost leaves its UAV out of the first slots.
LISTENER = """
from jfto_msgs_py.ros.installation import require_ros
require_ros()
import time
import rclpy
from std_msgs.msg import Float64MultiArray
from jfto_msgs_py.ros import qos, topics
from jfto_msgs_py.ros.network import decode_power_schedule
rclpy.init(args=[])
node, uavs = rclpy.create_node("listener"), []
def hear(message):
    uavs[:] = decode_power_schedule(message).uav_ids
node.create_subscription(Float64MultiArray, topics.POWER_SCHEDULE, hear, qos.latched())
end_s = time.monotonic() + LIMIT
while len(uavs) < 3 and time.monotonic() < end_s:
    rclpy.spin_once(node, timeout_sec=0.2)
print(",".join(uavs) or "nothing")
node.destroy_node()
rclpy.shutdown()
"""
TALKER = """
from jfto_msgs_py.ros.installation import require_ros
require_ros()
import rclpy
from std_msgs.msg import Empty
rclpy.init(args=[])
node = rclpy.create_node("talker")
talk = node.create_publisher(Empty, "talk", 10)
node.create_timer(0.1, lambda: talk.publish(Empty()))
rclpy.spin(node)
"""
HEARER = """
from jfto_msgs_py.ros.installation import require_ros
require_ros()
import rclpy
from std_msgs.msg import Empty
rclpy.init(args=[])
node, heard = rclpy.create_node("hearer"), []
def hear(message):
    heard.append(message)
    print("heard", len(heard), flush=True)
node.create_subscription(Empty, "talk", hear, 10)
print("ready", flush=True)
rclpy.spin(node)
"""


def _run(*command: str) -> None:
    subprocess.run(command, check=True, capture_output=True, text=True, timeout=10)


def _is_up(space: str) -> bool:
    """Whether the host's interface carries: Fast DDS never again looks at one that did not."""
    command = ["ip", "-n", space, "-json", "link", "show", "eth0"]
    shown = subprocess.run(command, check=True, capture_output=True, timeout=10).stdout
    return json.loads(shown)[0]["operstate"] == "UP"


def _reason_to_skip() -> str:
    if shutil.which("ip") is None:
        return "ip is not installed"
    name = f"jfto{os.getpid()}try"
    tried = subprocess.run(
        ["ip", "netns", "add", name], check=False, capture_output=True, text=True
    )
    if tried.returncode != 0:
        return f"network namespaces are not allowed: {tried.stderr.strip()}"
    _run("ip", "netns", "delete", name)
    return ""


class _Hosts:
    """Three namespaces on a switch in a fourth that loses 10 % of frames and delays all 50 ms.

    With `multicast` hosts look for one another on the network; else they are given addresses.
    """

    def __init__(self, stack: ExitStack, *, multicast: bool) -> None:
        self.stack, self._multicast = stack, multicast
        self._prefix = f"jfto{os.getpid()}"
        self.address = {host: f"10.213.0.{number}" for number, host in enumerate(HOSTS, 1)}
        switch = self._namespace("switch")
        ports = [f"p{number}" for number in range(len(HOSTS))]
        for port, host in zip(ports, HOSTS, strict=True):
            space = self._namespace(host)
            self._in(switch, "ip", "link", "add", port, "type", "veth", "peer", "name", "eth0",
                     "netns", space)  # fmt: skip
            self._in(switch, "ip", "link", "set", port, "up")
            self._in(space, "ip", "address", "add", f"{self.address[host]}/24", "dev", "eth0")
            self._in(space, "ip", "link", "set", "lo", "up")
            switched = "on" if multicast else "off"
            self._in(space, "ip", "link", "set", "eth0", "multicast", switched, "up")
            if multicast:
                self._in(space, "ip", "route", "add", "224.0.0.0/4", "dev", "eth0")
        forwarder = subprocess.Popen(
            ["ip", "netns", "exec", switch, sys.executable, lossy_switch.__file__,
             "0.1", "0.05", "1", *ports],
            stdout=subprocess.PIPE,
            text=True,
        )  # fmt: skip
        stack.callback(_end, forwarder)
        assert forwarder.stdout is not None
        stack.callback(forwarder.stdout.close)
        assert forwarder.stdout.readline() == "ready\n"
        for host in HOSTS:
            _until(lambda space=f"{self._prefix}{host}": _is_up(space))

    def _namespace(self, host: str) -> str:
        name = f"{self._prefix}{host}"
        _run("ip", "netns", "add", name)
        self.stack.callback(_run, "ip", "netns", "delete", name)
        return name

    def _in(self, space: str, *command: str) -> None:
        _run("ip", "netns", "exec", space, *command)

    def start(self, host: str, *command: str, log: Path, asked: bool = True) -> subprocess.Popen:
        """A Python process on a host, which looks for the others where it is `asked` to."""
        others = ";".join(self.address[other] for other in HOSTS if other != host)
        environment = {name: each for name, each in os.environ.items() if name not in OF_OURS}
        if asked and self._multicast:
            environment[DISCOVERY] = "SUBNET"
        elif asked:
            environment |= {DISCOVERY: "LOCALHOST", "ROS_STATIC_PEERS": others}
        source = str(Path(__file__).parents[2] / "src")
        with log.open("w") as output:
            process = subprocess.Popen(
                ["ip", "netns", "exec", f"{self._prefix}{host}", sys.executable, *command],
                env={**environment, "PYTHONPATH": source, "ROS_DOMAIN_ID": "0"},
                stdout=output,
                stderr=subprocess.STDOUT,
            )
        self.stack.callback(_end, process)
        return process


def _end(process: subprocess.Popen) -> None:
    process.terminate()
    try:
        process.wait(5)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()


def _params_file(path: Path) -> Path:
    lines = [f"    {name}: {value}" for name, value in SCENARIO.items()]
    path.write_text("/**:\n  ros__parameters:\n" + "\n".join(lines) + "\n")
    return path


@pytest.mark.parametrize("multicast", [False, True], ids=["static peers", "subnet"])
def test_three_hosts_converge_over_a_bad_radio(tmp_path, multicast) -> None:
    """With 10 % loss and 50 ms delay each way a schedule comes.

    Hosts find one another by ROS_STATIC_PEERS where there is no multicast, else by looking through
    the SUBNET.
    """
    reason = _reason_to_skip()
    if reason:
        pytest.skip(reason)
    scenario = make_scenario([{name: Given(value, "test") for name, value in SCENARIO.items()}])
    plan = tmp_path / "plan.json"
    write_plan(side_by_side(scenario), plan)
    params = str(_params_file(tmp_path / "scenario.yaml"))
    own = {
        "planner_node": ["-p", f"plan_file:={plan}", "-p", "start_delay_s:=0.0"],
        "pose_player": [],
        "topology_node": ["-p", "horizon_slots:=4", "-p", "pose_wait_s:=0.5"],
        "power_node": [],
    }
    where = {"planner_node": "planner", "pose_player": "planner", "topology_node": "topology",
             "power_node": "power"}  # fmt: skip
    with ExitStack() as stack:
        hosts = _Hosts(stack, multicast=multicast)
        for name, options in own.items():
            hosts.start(
                where[name], "-m", "jfto.nodes", name, "--ros-args", "--params-file", params,
                *options, log=tmp_path / f"{name}.log",
            )  # fmt: skip
        heard = tmp_path / "listener.log"
        code = LISTENER.replace("LIMIT", str(LIMIT_S))
        listener = hosts.start("power", "-c", code, log=heard)
        _await(listener)
        logs = {file.name: file.read_text() for file in tmp_path.glob("*.log")}
    assert logs["listener.log"].split() == ["uav1,uav2,uav3"], logs


def test_nodes_keep_to_their_computer_unless_asked(tmp_path) -> None:
    """On a network with multicast, where ROS 2 by itself would find everybody."""
    reason = _reason_to_skip()
    if reason:
        pytest.skip(reason)
    with ExitStack() as stack:
        hosts = _Hosts(stack, multicast=True)
        logs = {name: tmp_path / f"{name}.log" for name in ("near", "far", "talker")}
        for name, host in (("far", "topology"), ("near", "planner")):
            hosts.start(host, "-c", HEARER, log=logs[name], asked=False)
        _until(lambda: all("ready" in logs[name].read_text() for name in ("near", "far")))
        hosts.start("planner", "-c", TALKER, log=logs["talker"], asked=False)
        _until(lambda: "heard 30" in logs["near"].read_text())
        assert logs["far"].read_text().split() == ["ready"]


def _until(condition: Callable[[], bool]) -> None:
    end, tick = time.monotonic() + LIMIT_S, threading.Event()
    while not condition():
        assert time.monotonic() < end
        tick.wait(0.05)


def _await(process: subprocess.Popen) -> None:
    end, tick = time.monotonic() + LIMIT_S + 10, threading.Event()
    while process.poll() is None and time.monotonic() < end:
        tick.wait(0.05)
