"""Smoothing measured: `python bench/smoothing.py [ROUTES]`.

Closed form, continuity, limits at 1000 samples per segment, time against stop-and-go and against
straight lines at full speed over random routes, and a fleet of 8 routes with 136 waypoints.
"""

from __future__ import annotations

import sys
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "test"))

from jfto_planner.smoothing import CurveLimits, RouteRequest, rest_to_rest_s, smooth_route
from jfto_planner.smoothing.kernel.segment import least_duration
from jfto_world.compiled import kernel
from support.curves import ratios_at_samples, straight_line_s, worst_jump

LIMITS = CurveLimits(speed_mps=10.0, climb_mps=5.0, descent_mps=3.0)


@kernel
def duration_of(start: np.ndarray, end: np.ndarray, lim: np.ndarray, room: np.ndarray) -> float:
    return least_duration(start, end, 1e3, lim, 256, room)


def closed_form() -> None:
    rng = np.random.default_rng(0)
    worst = 0.0
    for _ in range(300):
        length, speed = rng.uniform(1, 500), rng.uniform(2, 15)
        accel, jerk = rng.uniform(0.5, 6), rng.uniform(0.5, 20)
        limits = CurveLimits(speed, 5, 5, accel, 5, jerk, 60.0)
        start, end = np.zeros((3, 3)), np.zeros((3, 3))
        end[0, 0] = length
        exact = rest_to_rest_s(length, speed, accel, jerk)
        found = duration_of(start, end, limits.row(), np.empty((6, 3)))
        worst = max(worst, abs(found / exact - 1))
    print(f"rest to rest against the closed form, 300 segments: {100 * worst:.4f} % at most")


def random_route(rng: np.random.Generator, count: int, spread_m: float) -> np.ndarray:
    walk = np.cumsum(rng.uniform(-1, 1, (count, 2)), axis=0) * spread_m
    return np.column_stack([walk, rng.uniform(40, 40 + 0.2 * spread_m, count)])


def random_routes(count: int) -> None:
    print(f"\n{count} random routes of 12 points; limits {LIMITS}")
    print("mean step   time / straight lines   time / stop-and-go   worst limit ratio   worst jump")
    spreads = (30.0, 60.0, 120.0, 240.0, 480.0)
    for spread in spreads:
        rng = np.random.default_rng(int(spread))
        rows = []
        for _ in range(max(1, count // len(spreads))):
            route = random_route(rng, 12, spread)
            through = smooth_route(RouteRequest(route, LIMITS))
            stopped = smooth_route(RouteRequest(route, LIMITS, stop=np.ones(12, dtype=bool)))
            bound = straight_line_s(route, LIMITS)
            rows.append(
                (
                    through.end_s / bound,
                    through.end_s / stopped.end_s,
                    max(ratios_at_samples(through, LIMITS).values()),
                    worst_jump(through, LIMITS, float(np.abs(route).max())),
                )
            )
        t = np.array(rows)
        print(
            f"{0.77 * spread:7.0f} m   mean {t[:, 0].mean():.3f} max {t[:, 0].max():.3f}    "
            f"mean {t[:, 1].mean():.3f} max {t[:, 1].max():.3f}   {t[:, 2].max():.5f}   "
            f"        {t[:, 3].max():.1e}"
        )


def fleet() -> None:
    rng = np.random.default_rng(8)
    places = np.column_stack([rng.uniform(0, 1500, (136, 2)), rng.uniform(60, 160, 136)])
    order = np.argsort(np.arctan2(places[:, 1] - 750, places[:, 0] - 750))
    requests = []
    for part in np.array_split(order, 8):
        left, route = list(part), [np.array([750.0, 750.0, 60.0])]
        while left:
            near = min(left, key=lambda k: (np.linalg.norm(places[k] - route[-1]), k))
            left.remove(near)
            route.append(places[near])
        requests.append(RouteRequest(np.array(route), LIMITS))
    cpu, begin = time.process_time(), time.perf_counter()
    with ThreadPoolExecutor(2) as pool:
        flown = list(pool.map(smooth_route, requests))
    wall, spent = time.perf_counter() - begin, time.process_time() - cpu
    bound = [straight_line_s(r.points_m, LIMITS) for r in requests]
    ratio = sum(t.end_s for t in flown) / sum(bound)
    print(f"\n8 routes, 136 waypoints, 2 threads: {wall:.2f} s wall, {spent:.2f} s CPU, "
          f"time / straight lines {ratio:.3f}")  # fmt: skip


if __name__ == "__main__":
    closed_form()
    smooth_route(RouteRequest(random_route(np.random.default_rng(1), 6, 20.0), LIMITS))
    random_routes(int(sys.argv[1]) if len(sys.argv) > 1 else 500)
    fleet()
