"""A listener on the graph under test, and that graph under `jfto up`."""

from __future__ import annotations

import contextlib
import json
import os
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import rclpy
from rclpy.executors import SingleThreadedExecutor
from std_msgs.msg import Float64MultiArray, UInt8MultiArray
from trajectory_msgs.msg import MultiDOFJointTrajectory

from jfto_msgs_py.ros import qos, topics
from jfto_msgs_py.ros.network import decode_adjacency, decode_power_schedule
from jfto_msgs_py.ros.vehicle import decode_trajectory

LIMIT_S = 60.0
UAVS = 8
IDS = tuple(f"uav{number + 1}" for number in range(UAVS))
# Eight UAVs over drawn waypoints, planned in seconds: the planning is not what is measured.
SCENARIO = f"""\
/**:
  ros__parameters:
    terrain: {{center_deg: [36.6255, -84.2650], size_m: [1000.0, 1000.0]}}
    waypoints: {{source: uniform, count: 40}}
    fleet: {{count: {UAVS}, energy_j: [5000.0], speed_mps: [8.0]}}
    starts: {{count: 4}}
    mission: {{slot_count: SLOTS, horizon_s: HORIZON}}
    search: {{moves: 60000, starts: 1}}
"""


class Watcher:
    """Listens to the graph on its domain."""

    def __init__(self, domain: int) -> None:
        self.context = rclpy.context.Context()
        rclpy.init(args=[], context=self.context, domain_id=domain)
        self.node = rclpy.create_node("bench", context=self.context)
        self.executor = SingleThreadedExecutor(context=self.context)
        self.executor.add_node(self.node)
        self.heard: dict[str, tuple[int, float]] = {}
        self.trajectories: dict[str, object] = {}
        for topic, kind, decode in (
            (topics.ADJACENCY, UInt8MultiArray, decode_adjacency),
            (topics.POWER_SCHEDULE, Float64MultiArray, decode_power_schedule),
        ):
            self.node.create_subscription(
                kind,
                topic,
                lambda message, topic=topic, decode=decode: self._hear(topic, decode(message)),
                qos.latched(),
            )

    def _hear(self, topic: str, record: object) -> None:
        self.heard[topic] = (record.horizon.first, time.perf_counter())

    def join_late(self) -> None:
        """Subscribe anew to all trajectories."""
        self.trajectories.clear()
        for subscription in tuple(self.node.subscriptions):
            if subscription.topic_name.endswith("/trajectory"):
                self.node.destroy_subscription(subscription)
        for uav in IDS:
            self.node.create_subscription(
                MultiDOFJointTrajectory,
                topics.trajectory(uav),
                lambda message, uav=uav: self.trajectories.update(
                    {uav: decode_trajectory(message)}
                ),
                qos.latched(),
            )

    def spin_for(self, seconds: float) -> None:
        """Spin for some time."""
        end = time.monotonic() + seconds
        while (left_s := end - time.monotonic()) > 0:
            self.executor.spin_once(timeout_sec=left_s)

    def until(self, condition: Callable[[], bool], what: str, limit_s: float = LIMIT_S) -> None:
        """Spin until a condition holds."""
        end = time.monotonic() + limit_s
        while not condition():
            if time.monotonic() > end:
                sys.exit(f"Waited in vain for {limit_s:g} s: {what}.")
            self.executor.spin_once(timeout_sec=0.05)


@contextlib.contextmanager
def graph(domain: int, slots: int, horizon_s: float, *options: str) -> Iterator[Path]:
    """The graph under `jfto up`; yields its directory."""
    with tempfile.TemporaryDirectory() as directory:
        scenario = Path(directory) / "scene.yaml"
        text = SCENARIO.replace("SLOTS", str(slots)).replace("HORIZON", str(horizon_s))
        scenario.write_text(text, encoding="utf-8")
        out = Path(directory) / "up"
        process = subprocess.Popen(
            [sys.executable, "-m", "jfto", "up", str(scenario), "-o", str(out), *options],
            env={**os.environ, "ROS_DOMAIN_ID": str(domain)},
            stdout=subprocess.DEVNULL,
        )
        try:
            yield out
        finally:
            # Started in the background it would ignore SIGINT.
            process.send_signal(signal.SIGTERM)
            print(f"jfto up ended with status {process.wait()}")


def running(out: Path) -> dict[str, int]:
    """Process numbers of the graph's nodes by name."""
    state = json.loads((out / "status.json").read_text(encoding="utf-8"))
    return {name: node["pid"] for name, node in state.items() if node["pid"] is not None}


def domain() -> int:
    """A ROS domain that is likely nobody else's."""
    return os.getpid() % 100 + 1
