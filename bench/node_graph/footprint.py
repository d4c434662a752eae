"""What each process of the graph takes: start-up, memory, processor time."""

from __future__ import annotations

import os
import time
from pathlib import Path

import numpy as np
from geometry_msgs.msg import PoseStamped

from jfto_msgs_py.ros import qos, topics
from node_graph.watcher import IDS, LIMIT_S, UAVS, Watcher, domain, graph, running

_TICKS_S = os.sysconf("SC_CLK_TCK")


def memory(minutes: float) -> None:
    """Print how the resident memory of each process grows, with the bridge and a recorder."""
    watcher = Watcher(domain())
    poses: list[object] = []
    watcher.node.create_subscription(PoseStamped, topics.pose(IDS[0]), poses.append, qos.sensor())
    with graph(domain(), 3600, 3600.0, "--vehicles", "sim", "--record") as out:
        watcher.until(lambda: bool(poses), "poses", 10 * LIMIT_S)
        begun_s = time.monotonic()
        taken: dict[str, list[tuple[float, float]]] = {}
        while (at_s := time.monotonic() - begun_s) < 60 * minutes:
            for name, pid in running(out).items():
                taken.setdefault(name, []).append((at_s, _resident_mb(pid)))
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


def load(seconds: float) -> None:
    """Print start-up time, resident memory and processor time, with poses played at 10 Hz.

    Start-up is from the start of the process to its node's being seen on the graph.
    """
    watcher = Watcher(domain())
    with graph(domain(), 900, 900.0, "--poses", "plan", "--start-delay", "1", "--record") as out:
        watcher.until((out / "status.json").exists, "the supervisor")
        seen_s: dict[str, float] = {}

        def all_seen() -> bool:
            names = set(watcher.node.get_node_names())
            for name, pid in running(out).items():
                if name not in seen_s and _NODE_NAMES.get(name, name) in names:
                    seen_s[name] = _age_s(pid)
            return len(seen_s) == len(running(out))

        watcher.until(all_seen, "all nodes")
        watcher.until(lambda: topics.POWER_SCHEDULE in watcher.heard, "a schedule")
        watcher.spin_for(10.0)
        pids = running(out)
        before_s = {name: _cpu_s(pid) for name, pid in pids.items()}
        begun_s = time.monotonic()
        # Not spinning: what the listener takes does not belong to the graph.
        time.sleep(seconds)
        passed_s = time.monotonic() - begun_s
        shares = {name: (_cpu_s(pid) - before_s[name]) / passed_s for name, pid in pids.items()}
        print(f"A = {UAVS}, poses at 10 Hz, {seconds:g} s, load {os.getloadavg()[0]:.1f}")
        for name, pid in pids.items():
            print(
                f"{name:<16} seen after {seen_s[name]:4.1f} s  {_resident_mb(pid):6.1f} MB  "
                f"{100 * shares[name]:5.1f} % of a core"
            )
        print(f"{'all':<16} {100 * sum(shares.values()):38.1f} % of a core")
    watcher.context.try_shutdown()


# Where a node is not named after its process.
_NODE_NAMES = {"recorder": "rosbag2_recorder"}


def _resident_mb(pid: int) -> float:
    lines = Path(f"/proc/{pid}/status").read_text(encoding="utf-8").splitlines()
    return next(int(line.split()[1]) for line in lines if line.startswith("VmRSS")) / 1024


def _stat(pid: int) -> list[str]:
    return Path(f"/proc/{pid}/stat").read_text(encoding="utf-8").rpartition(")")[2].split()


def _cpu_s(pid: int) -> float:
    fields = _stat(pid)
    return (int(fields[11]) + int(fields[12])) / _TICKS_S


def _age_s(pid: int) -> float:
    return time.clock_gettime(time.CLOCK_BOOTTIME) - int(_stat(pid)[19]) / _TICKS_S
