"""What the learned planner takes on a small computer: time of its parts, and memory.

    OPENBLAS_NUM_THREADS=1 python bench/policy_footprint.py [--waypoints 136] [--uavs 8]

One random scene, one core. Exit status 1 if a greedy plan takes more than 300 ms or the process
more than 500 MB.
"""

from __future__ import annotations

import argparse
import resource
import sys
import time

BEGUN = time.perf_counter()

import numpy as np  # noqa: E402 - the clock runs while modules load

from jfto_planner.policy.inference import ranked_routes  # noqa: E402
from jfto_planner.policy.weights import load_weights  # noqa: E402
from jfto_planner.routing import RoutingProblem  # noqa: E402
from jfto_world.motion import ConstantSpeed, MotionLimits  # noqa: E402

IMPORTED = time.perf_counter()
EXTENT_M = 2000.0
MOST_MS, MOST_MB = 300.0, 500.0


def random_problem(waypoints: int, uavs: int) -> RoutingProblem:
    """Uniform waypoints about four starts in the middle, of a fleet that hears one another."""
    random = np.random.default_rng(0)
    corners = np.array([[0.4, 0.4, 0], [0.6, 0.4, 0], [0.4, 0.6, 0], [0.6, 0.6, 0]])
    starts = corners[np.arange(uavs) % 4] * EXTENT_M
    starts[:, 0] += 10.0 * (np.arange(uavs) // 4)
    return RoutingProblem(
        waypoints_m=random.random((waypoints, 3)) * [EXTENT_M, EXTENT_M, 200.0],
        starts_m=starts,
        limits=(MotionLimits(10.0, 5.0, 4.0),) * uavs,
        time_model=ConstantSpeed(),
        t_max_s=np.full(uavs, 450.0),
        reach_m=np.full(uavs, 0.9 * EXTENT_M),
        k_min=2,
        d_min_m=0.0,
        length_max_m=1e7,
        slot_count=150,
    )


def main() -> int:
    """Print times and memory; the status is 1 if a limit is passed."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--waypoints", type=int, default=136)
    parser.add_argument("--uavs", type=int, default=8)
    chosen = parser.parse_args()
    problem = random_problem(chosen.waypoints, chosen.uavs)
    begun = time.perf_counter()
    policy = load_weights()
    loaded = time.perf_counter()
    ranked_routes(policy, problem, mode="greedy", most=1)
    compiled = time.perf_counter()
    print(
        f"imports {IMPORTED - BEGUN:.2f} s, weights {1e3 * (loaded - begun):.1f} ms, "
        f"first plan with compilation or its cache {compiled - loaded:.2f} s"
    )
    times = {}
    for mode in ("greedy", "symmetry", "sample"):
        wall, used = [], []
        for _ in range(7):
            start, start_cpu = time.perf_counter(), time.process_time()
            (found,) = ranked_routes(policy, problem, mode=mode, most=1)
            wall.append(1e3 * (time.perf_counter() - start))
            used.append(1e3 * (time.process_time() - start_cpu))
        times[mode] = float(np.median(used))
        print(
            f"{mode:9s} {np.median(wall):7.1f} ms by the clock, {times[mode]:7.1f} ms of CPU, "
            f"{found.length_m / 1000:.2f} km"
        )
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    torch = "with" if "torch" in sys.modules else "without"
    print(f"greatest memory {memory:.0f} MB, {torch} torch")
    return int(times["greedy"] > MOST_MS or memory > MOST_MB)


if __name__ == "__main__":
    raise SystemExit(main())
