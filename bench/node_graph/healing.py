"""How long the graph takes to be whole again after `kill -9`."""

from __future__ import annotations

import json
import os
import random
import signal
import time
from pathlib import Path

import numpy as np

from jfto_msgs_py.ros import topics
from node_graph.watcher import UAVS, Watcher, domain, graph


def heal(kills: int, seed: int) -> None:
    """Print how long the graph takes to be whole after a kill."""
    rng = random.Random(seed)
    watcher = Watcher(domain())
    with graph(domain(), 3600, 3600.0, "--poses", "plan", "--start-delay", "1") as out:
        watcher.join_late()
        watcher.until(lambda: topics.POWER_SCHEDULE in watcher.heard, "a schedule")
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

    watcher.until(is_back, f"{name} to be back")
    back_s = time.perf_counter()
    watcher.join_late()
    watcher.until(lambda: len(watcher.trajectories) == UAVS, "all trajectories")
    for topic in (topics.ADJACENCY, topics.POWER_SCHEDULE):
        watcher.until(
            lambda topic=topic: watcher.heard[topic][1] > max(back_s, killed_s), f"news on {topic}"
        )
