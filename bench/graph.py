"""How fast the node graph answers, and how it heals.

Latency: planner, topology and power run as processes under the supervisor, on simulated time; ten
slots a second, which is slots of 1 s at ten times real time, all poses of a slot are sent at once,
and the time from the last of them to the adjacency and to the schedule of that slot is taken.
Between slots a fixed piece of work is timed too: how much longer it takes at times is how much the
computer itself spreads.

Healing: on wall time under `jfto up`, nodes picked at random are killed with -9; the graph is whole
again when the dead node's process is back and what the graph says next has been heard: a schedule
of a newer slot, and, by a late joiner, the latched trajectories.

    python bench/graph.py latency [--slots 300]
    python bench/graph.py heal [--kills 50]
    python bench/graph.py memory [--minutes 10]

Memory: planner, topology, power, bridge, simulated vehicles and recorder run under
`jfto up --vehicles sim --record`; resident memory of each is taken every ten seconds once all are
linked.
"""

from __future__ import annotations

import argparse
import contextlib
import json
import os
import random
import signal
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from jfto_msgs_py.ros.installation import require_ros

require_ros()

import rclpy  # noqa: E402
from geometry_msgs.msg import PoseStamped  # noqa: E402
from rclpy.executors import SingleThreadedExecutor  # noqa: E402
from rosgraph_msgs.msg import Clock  # noqa: E402
from std_msgs.msg import Float64MultiArray, UInt8MultiArray  # noqa: E402
from trajectory_msgs.msg import MultiDOFJointTrajectory  # noqa: E402

from jfto_msgs_py.ros import qos, topics  # noqa: E402
from jfto_msgs_py.ros.network import decode_adjacency, decode_power_schedule  # noqa: E402
from jfto_msgs_py.ros.stamps import encode_time  # noqa: E402
from jfto_msgs_py.ros.vehicle import decode_trajectory, encode_pose  # noqa: E402
from jfto_msgs_py.vehicle import VehiclePose  # noqa: E402
from jfto_world.motion.progress import sample  # noqa: E402

LIMIT_S = 60.0
SLOT_S = 0.1
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

    def until(self, condition: object, limit_s: float = LIMIT_S) -> None:
        """Spin until a condition holds."""
        end = time.monotonic() + limit_s
        while not condition():
            if time.monotonic() > end:
                sys.exit("the graph does not answer")
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


def latency(slots: int) -> None:
    """Print the latency from the last pose to adjacency and schedule."""
    domain = os.getpid() % 100 + 1
    watcher = Watcher(domain)
    clock = watcher.node.create_publisher(Clock, "/clock", 10)
    poses = [
        watcher.node.create_publisher(PoseStamped, topics.pose(uav), qos.sensor()) for uav in IDS
    ]
    first_ns = 1_800_000_000 * 10**9
    with graph(domain, slots, 0.0, "--use-sim-time", "--start-delay", "1"):
        watcher.until(lambda: clock.get_subscription_count() >= 3)
        clock.publish(Clock(clock=encode_time(first_ns)))
        watcher.join_late()
        watcher.until(lambda: len(watcher.trajectories) == UAVS)
        watcher.until(lambda: all(p.get_subscription_count() >= 2 for p in poses))
        plans = [watcher.trajectories[uav] for uav in IDS]
        start_ns = plans[0].start_ns
        duration_ns = max(int(plan.offset_ns[-1]) for plan in plans) / slots
        taken: dict[str, list[float]] = {topics.ADJACENCY: [], topics.POWER_SCHEDULE: []}
        alone: list[float] = []
        tick = threading.Event()
        for slot in range(slots):
            now_ns = start_ns + round((slot + 0.01) * duration_ns)
            clock.publish(Clock(clock=encode_time(now_ns)))
            # Time spreads before the poses do.
            tick.wait(SLOT_S)
            alone.append(_fixed_work_ms())
            messages = [_pose(plan, now_ns) for plan in plans]
            for publisher, message in zip(poses, messages, strict=True):
                publisher.publish(message)
            sent_s = time.perf_counter()
            watcher.until(
                lambda slot=slot: watcher.heard.get(topics.POWER_SCHEDULE, (-1, 0.0))[0] >= slot
            )
            for topic, times in taken.items():
                times.append(1e3 * (watcher.heard[topic][1] - sent_s))
    watcher.context.try_shutdown()
    print(f"A = {UAVS}, horizon 10 slots, {slots} slots, load {os.getloadavg()[0]:.1f}")
    for topic, times in taken.items():
        # The first slots load what the kernels need.
        p50, p90, p99 = np.percentile(times[3:], [50, 90, 99])
        print(f"pose to {topic:<26} p50 {p50:5.1f}  p90 {p90:5.1f}  p99 {p99:5.1f} ms")
    p50, p90, p99 = np.percentile(alone, [50, 90, 99])
    print(f"{'the same work each time':<34} p50 {p50:5.1f}  p90 {p90:5.1f}  p99 {p99:5.1f} ms")


def _fixed_work_ms() -> float:
    """Wall time of a loop that takes some 10 ms."""
    begun_s = time.perf_counter()
    sum(number * number for number in range(120_000))
    return 1e3 * (time.perf_counter() - begun_s)


def _pose(plan: object, now_ns: int) -> object:
    at_s = np.array([(now_ns - plan.start_ns) / 1e9])
    east, north, up = sample(plan.offset_ns / 1e9, plan.position_m, at_s)[0].tolist()
    return encode_pose(VehiclePose(now_ns, (east, north, up), 0.0))


def memory(minutes: float) -> None:
    """Print how the resident memory of each process grows, with the bridge and a recorder."""
    domain = os.getpid() % 100 + 1
    watcher = Watcher(domain)
    poses: list[object] = []
    watcher.node.create_subscription(PoseStamped, topics.pose(IDS[0]), poses.append, qos.sensor())
    with graph(domain, 3600, 3600.0, "--vehicles", "sim", "--record") as out:
        watcher.until(lambda: poses, 10 * LIMIT_S)
        begun_s = time.monotonic()
        taken: dict[str, list[tuple[float, float]]] = {}
        while (at_s := time.monotonic() - begun_s) < 60 * minutes:
            state = json.loads((out / "status.json").read_text(encoding="utf-8"))
            for name, node in state.items():
                taken.setdefault(name, []).append((at_s, _resident_mb(node["pid"])))
            watcher.spin_for(10.0)
            poses.clear()
    watcher.context.try_shutdown()
    print(f"A = {UAVS}, {minutes:g} min, load {os.getloadavg()[0]:.1f}")
    for name, samples in taken.items():
        # The first minute still loads and compiles.
        settled = np.array([sample for sample in samples if sample[0] >= 60.0] or samples)
        slope = np.polyfit(settled[:, 0] / 60.0, settled[:, 1], 1)[0] if len(settled) > 1 else 0.0
        print(
            f"{name:<16} {settled[0, 1]:6.1f} -> {settled[-1, 1]:6.1f} MB, "
            f"{1000 * slope:+.0f} kB a minute"
        )


def _resident_mb(pid: int) -> float:
    lines = Path(f"/proc/{pid}/status").read_text(encoding="utf-8").splitlines()
    return next(int(line.split()[1]) for line in lines if line.startswith("VmRSS")) / 1024


def heal(kills: int, seed: int) -> None:
    """Print how long the graph takes to be whole after a kill."""
    domain = os.getpid() % 100 + 1
    rng = random.Random(seed)
    watcher = Watcher(domain)
    with graph(domain, 3600, 3600.0, "--poses", "plan", "--start-delay", "1") as out:
        watcher.join_late()
        watcher.until(lambda: topics.POWER_SCHEDULE in watcher.heard)
        rows: list[tuple[str, float]] = []
        for number in range(kills):
            state = json.loads((out / "status.json").read_text(encoding="utf-8"))
            name = rng.choice(sorted(state))
            pid = state[name]["pid"]
            os.kill(pid, signal.SIGKILL)
            killed_s = time.perf_counter()
            _await_whole(watcher, out, name, pid, killed_s)
            rows.append((name, time.perf_counter() - killed_s))
            print(f"{number + 1:3d}  {name:<14} {rows[-1][1]:.2f} s", flush=True)
    watcher.context.try_shutdown()
    taken = np.array([seconds for _, seconds in rows])
    print(
        f"{kills} kills, load {os.getloadavg()[0]:.1f}: median {np.median(taken):.2f} s, "
        f"greatest {taken.max():.2f} s"
    )


def _await_whole(watcher: Watcher, out: Path, name: str, pid: int, killed_s: float) -> None:
    def is_back() -> bool:
        state = json.loads((out / "status.json").read_text(encoding="utf-8"))
        return state[name]["pid"] not in {None, pid} and name in watcher.node.get_node_names()

    watcher.until(is_back)
    back_s = time.perf_counter()
    watcher.join_late()
    watcher.until(lambda: len(watcher.trajectories) == UAVS)
    for topic in (topics.ADJACENCY, topics.POWER_SCHEDULE):
        watcher.until(lambda topic=topic: watcher.heard[topic][1] > max(back_s, killed_s))


def main() -> None:
    """Read the command line and run what it names."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("what", choices=["latency", "heal", "memory"])
    parser.add_argument("--slots", type=int, default=300)
    parser.add_argument("--kills", type=int, default=50)
    parser.add_argument("--minutes", type=float, default=10.0)
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args()
    if options.what == "latency":
        latency(options.slots)
    elif options.what == "memory":
        memory(options.minutes)
    else:
        heal(options.kills, options.seed)


if __name__ == "__main__":
    main()
