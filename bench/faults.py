"""Flights with a fault each, through `jfto run`: what is told, what remains, how each UAV ends.

The kinds of fault take turns; the UAV and the moment, between take-off and the last waypoint, are
drawn. A run fails where it hangs, where its bag is not whole or lacks an event that was heard,
where a vehicle has no end, where no line tells of the fault, or where somebody else does not pass
all waypoints.

    python bench/faults.py [--runs 20] [--seed 0] [--speedup 10] [--kinds gps,battery]
"""

from __future__ import annotations

import argparse
import json
import os
import random
import signal
import socket
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from jfto_msgs_py.ros.installation import require_ros

require_ros()

import rclpy  # noqa: E402
from rcl_interfaces.msg import Log  # noqa: E402
from rclpy.executors import SingleThreadedExecutor  # noqa: E402
from rclpy.serialization import deserialize_message  # noqa: E402
from rosgraph_msgs.msg import Clock  # noqa: E402
from std_msgs.msg import Float64MultiArray, Header  # noqa: E402

from jfto.bag.reader import Bag  # noqa: E402
from jfto_msgs_py.records.event import Event  # noqa: E402
from jfto_msgs_py.ros import qos, topics  # noqa: E402
from jfto_msgs_py.ros.events import decode_event  # noqa: E402
from jfto_msgs_py.ros.lift_off import decode_lift_off  # noqa: E402
from jfto_msgs_py.ros.stamps import decode_time  # noqa: E402

LIMIT_S = 900.0
IDS = ("uav1", "uav2", "uav3", "uav4")
# Four UAVs that reach each other everywhere, a dozen waypoints.
SCENARIO = """\
/**:
  ros__parameters:
    terrain: {center_deg: [36.6255, -84.2650], size_m: [500.0, 500.0]}
    waypoints: {source: uniform, count: 12}
    camera: {sensor_mm: [17.3, 13.0], focal_length_mm: 20.0, image_px: [5280, 3956]}
    coverage: {distance_m: 130.0}
    fleet: {count: 4, energy_j: [500.0], speed_mps: [8.0]}
    starts: {count: 2}
    mission: {slot_count: 20}
    search: {moves: 20000, starts: 1}
"""


@dataclass(frozen=True)
class Kind:
    """A fault: a line for the simulator, or a process to kill, and the event that tells of it."""

    line: str
    process: str
    event: str


KINDS = {
    "killed": Kind("kill {n}", "", "vehicle"),
    "radio": Kind("radio {n} dead", "", "radio"),
    "gps": Kind("gps {n} off", "", "gps"),
    "battery": Kind("battery {n} 10.2", "", "battery"),
    "bridge": Kind("", "mavlink_bridge", "restart"),
    "topology": Kind("", "topology_node", "restart"),
    "power": Kind("", "power_node", "restart"),
}
# Vehicles that cannot finish their routes after such a fault.
UNFIT = ("killed", "gps", "battery")


@dataclass
class Run:
    """One flight and what came of it."""

    kind: str
    uav: str
    at_s: float
    status: int | None = None
    wall_s: float = 0.0
    messages: int = 0
    told: str = ""
    connected: float = float("nan")
    wrong: list[str] = field(default_factory=list)


class Watcher:
    """Listens to one run on its domain."""

    def __init__(self, domain: int) -> None:
        self.context = rclpy.context.Context()
        rclpy.init(args=[], context=self.context, domain_id=domain)
        self.node = rclpy.create_node("faults", context=self.context)
        self.executor = SingleThreadedExecutor(context=self.context)
        self.executor.add_node(self.node)
        self.events: list[Event] = []
        self.now_ns = 0
        self.lift_off_ns = 0
        node = self.node
        node.create_subscription(Log, topics.EVENTS, self._hear, qos.events())
        node.create_subscription(Clock, topics.CLOCK, self._tick, qos.clock())
        node.create_subscription(Header, topics.LIFT_OFF, self._lift_off, qos.latched())

    def _hear(self, message: Log) -> None:
        self.events.append(decode_event(message))

    def _tick(self, message: Clock) -> None:
        self.now_ns = decode_time(message.clock)

    def _lift_off(self, message: Header) -> None:
        self.lift_off_ns, _ = decode_lift_off(message)

    def flown_s(self) -> float:
        """Seconds of the vehicles' time since lift-off, negative before."""
        return (self.now_ns - self.lift_off_ns) / 1e9 if self.lift_off_ns else -1.0

    def spin_until(self, condition: object, process: subprocess.Popen[bytes], end_s: float) -> bool:
        """Listen until a condition holds; False where the process or the time ends first."""
        while not condition():
            if process.poll() is not None or time.monotonic() > end_s:
                return False
            self.executor.spin_once(timeout_sec=0.05)
        return True

    def close(self) -> None:
        """Leave the domain."""
        self.executor.shutdown()
        self.node.destroy_node()
        self.context.try_shutdown()


def fly(run: Run, directory: Path, plan: Path, domain: int, speedup: float) -> list[Event]:
    """One flight with its fault; returns the events heard while it went on."""
    scenario = directory / "scene.yaml"
    scenario.write_text(SCENARIO, encoding="utf-8")
    out = directory / "run"
    command = [sys.executable, "-m", "jfto", "run", str(scenario), "-o", str(out)]
    command += ["--plan", str(plan), "--vehicles", "sim", "--speedup", f"{speedup:g}"]
    watcher = Watcher(domain)
    begun_s = time.monotonic()
    end_s = begun_s + LIMIT_S
    with (directory / "output").open("wb") as output:
        process = subprocess.Popen(
            command,
            env={**os.environ, "ROS_DOMAIN_ID": str(domain)},
            stdout=output,
            stderr=subprocess.STDOUT,
        )
        try:
            if watcher.spin_until(lambda: watcher.flown_s() >= run.at_s, process, end_s):
                inject(run, out)
            else:
                run.wrong.append("ended before the fault")
            watcher.spin_until(lambda: False, process, end_s)
            run.status = process.poll()
        finally:
            if process.poll() is None:
                run.wrong.append(f"hangs after {LIMIT_S:g} s")
                process.send_signal(signal.SIGINT)
                process.send_signal(signal.SIGINT)
                process.wait(LIMIT_S)
            watcher.close()
    run.wall_s = time.monotonic() - begun_s
    return watcher.events


def inject(run: Run, out: Path) -> None:
    """Let it happen."""
    kind = KINDS[run.kind]
    state = json.loads((out / "status.json").read_text(encoding="utf-8"))
    if kind.process:
        os.kill(state[kind.process]["pid"], signal.SIGKILL)
        return
    words = Path(f"/proc/{state['simulated_fleet']['pid']}/cmdline").read_text().split("\0")
    (port,) = [int(word.partition(":=")[2]) for word in words if word.startswith("control_port:=")]
    line = kind.line.format(n=IDS.index(run.uav) + 1)
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
        sender.settimeout(30.0)
        sender.sendto(line.encode(), ("127.0.0.1", port))
        answer = sender.recv(512).decode()
    if answer.startswith("error"):
        run.wrong.append(answer)


def judge(run: Run, heard: Sequence[Event], out: Path) -> None:
    """Read the record back and find what is wrong with the run."""
    bag = Bag(out / "bag")
    if not bag.facts.complete:
        run.wrong.append("bag is not whole")
    events: list[Event] = []
    joined: list[bool] = []
    for message in bag.messages():
        run.messages += 1
        if message.topic == topics.EVENTS:
            events.append(decode_event(deserialize_message(message.data, Log)))
        elif message.topic == topics.AIR_RATE and events_kind(events, "lift_off"):
            joined.append(_connected(deserialize_message(message.data, Float64MultiArray), run))
    lost = [event.text for event in heard if event not in events]
    if lost:
        run.wrong.append(f"{len(lost)} events not in the bag, first: {lost[0]}")
    run.connected = float(np.mean(joined)) if joined else float("nan")
    kind = KINDS[run.kind]
    uav = "" if kind.process else run.uav
    told = [e.text for e in events if (e.kind, e.uav_id) == (kind.event, uav) and e.level >= 30]
    run.told = told[0] if told else ""
    if not told:
        run.wrong.append("no line tells of the fault")
    over = [e.text for e in events if (e.kind, e.uav_id) == ("landed", "")]
    ends = over[-1] if over else ""
    without = [one for one in IDS if f"{one} landed" not in ends and f"{one} declared" not in ends]
    if without:
        run.wrong.append(f"no end: {', '.join(without)}")
    unfit = run.uav if run.kind in UNFIT else ""
    done = {event.uav_id for event in events if event.kind == "done"}
    if run.kind == "bridge":
        # On a busy computer it may come back after they have landed; nobody saw the last ones then.
        done |= {one for one in IDS if f"{one} landed on its pad" in ends}
    short = [one for one in IDS if one not in done and one != unfit]
    if short:
        run.wrong.append(f"waypoints left: {', '.join(short)}")


def events_kind(events: Sequence[Event], kind: str) -> bool:
    """Whether there was an event of a kind."""
    return any(event.kind == kind for event in events)


def _connected(message: Float64MultiArray, run: Run) -> bool:
    """Whether all UAVs that have a radio left are one network."""
    count = len(IDS)
    links = np.array(message.data).reshape(count, count) > 0
    sending = np.flatnonzero(links.any(axis=0))
    if sending.size == 0:
        return False
    reach = np.linalg.matrix_power(links.astype(int) + np.eye(count, dtype=int), count) > 0
    left = [k for k, uav in enumerate(IDS) if uav != run.uav or run.kind not in ("killed", "radio")]
    return bool(reach[np.ix_(left, left)].all())


def main() -> int:
    """Read the command line, fly, print a table; status 1 where a run failed."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--runs", type=int, default=20)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--speedup", type=float, default=10.0)
    parser.add_argument("--kinds", default=",".join(KINDS))
    parser.add_argument("--plan", type=Path, help="The plan that all fly; else made.")
    parser.add_argument("--keep", type=Path, metavar="DIR", help="Keep all runs there.")
    options = parser.parse_args()
    rng = random.Random(options.seed)
    kinds = options.kinds.split(",")
    runs = [
        Run(kinds[number % len(kinds)], rng.choice(IDS), rng.uniform(5.0, 45.0))
        for number in range(options.runs)
    ]
    with tempfile.TemporaryDirectory() as temporary:
        top = options.keep or Path(temporary)
        top.mkdir(parents=True, exist_ok=True)
        plan = options.plan or make_plan(top)
        for number, run in enumerate(runs, 1):
            directory = top / f"run{number:02d}-{run.kind}"
            directory.mkdir()
            domain = (os.getpid() + number) % 100 + 1
            heard = fly(run, directory, plan, domain, options.speedup)
            judge(run, heard, directory / "run")
            tell(number, run)
    bad = [run for run in runs if run.wrong]
    print(f"{len(runs)} runs, {len(bad)} failed, load {os.getloadavg()[0]:.1f}")
    return 1 if bad else 0


def make_plan(top: Path) -> Path:
    """The plan that all runs fly."""
    scenario, plan = top / "plan.yaml", top / "plan.json"
    scenario.write_text(SCENARIO, encoding="utf-8")
    command = [sys.executable, "-m", "jfto", "plan", str(scenario), "-o", str(plan)]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    return plan


def tell(number: int, run: Run) -> None:
    """One line of the table, and below it what was told and what is wrong."""
    who = "" if KINDS[run.kind].process else run.uav
    print(
        f"{number:2d}  {run.kind:<9} {who:<5} at {run.at_s:5.1f} s  status {run.status}  "
        f"{run.wall_s:5.1f} s  {run.messages:6d} messages  connected {100 * run.connected:5.1f} %  "
        f"{'ok' if not run.wrong else 'FAILED: ' + '; '.join(run.wrong)}"
    )
    print(f"      {run.told}", flush=True)


if __name__ == "__main__":
    sys.exit(main())
