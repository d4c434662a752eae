"""How long C-TOP takes as fleets and plans grow, what it makes of them, and how far from the best.

    python bench/topology.py [--repeat 9] [--bound 3]

Times are medians of repeated runs in one process; the first line is the cost of compiling, once per
installation.
"""

from __future__ import annotations

import argparse
import os
import statistics
import subprocess
import sys
import tempfile
import time
from dataclasses import replace

import numpy as np

from jfto_msgs_py.records.radio import Radio
from jfto_msgs_py.units import dbm_to_w
from jfto_topology.algorithms.cpapo import cpapo
from jfto_topology.algorithms.ctop import ctop, energy_floor
from jfto_topology.algorithms.elastic import Air, ctop_elastic
from jfto_topology.algorithms.lmst import a_lmst
from jfto_world.radio import make_channel, noise_w, pairwise_distances
from optimal_topology import optimal_bits
from random_fleet import wandering_fleet

RADIO = Radio()
CHANNEL = make_channel(RADIO)
SENSITIVITY_W = dbm_to_w(RADIO.sensitivity_dbm)
K_MIN, DELTA, SLOT_S = 2, 2, 3.0

FIRST_CALL = """
import time
import numpy as np
from jfto_topology.algorithms.ctop import ctop
from jfto_world.radio import LogDistanceChannel
start = time.perf_counter()
positions = np.random.default_rng(0).uniform(0, 9, (2, 8, 3))
ctop(positions, LogDistanceChannel(1.0), np.ones(8), 1e-3, 2, 2)
print(time.perf_counter() - start)
"""


def first_call_s(cache: str) -> float:
    """Seconds of the first call in a new process with the given cache of compiled code."""
    environment = os.environ | {"NUMBA_CACHE_DIR": cache}
    done = subprocess.run(
        [sys.executable, "-c", FIRST_CALL],
        env=environment,
        check=True,
        capture_output=True,
        text=True,
    )
    return float(done.stdout)


def median_ms(action, repeat: int) -> float:
    action()
    times = []
    for _ in range(repeat):
        start = time.perf_counter()
        action()
        times.append(time.perf_counter() - start)
    return 1e3 * statistics.median(times)


def air_of(positions, caps_w) -> Air:
    gain = CHANNEL.gain(pairwise_distances(positions))
    return Air(gain, caps_w, SENSITIVITY_W, noise_w(RADIO))


def carried_bits(top, air: Air) -> np.ndarray:
    """What listed links carry at the greatest powers of their intervals, bit/s/Hz by slot."""
    rate = np.log2(1 + top.p_upper_w[:, :, None] * air.gain / air.noise_w)
    return np.where(top.adjacency, rate, 0.0).sum(axis=(1, 2)) / 2


def bound(fleets: int, every: int = 5) -> None:
    """Shares of the optimum of each slot, energy left aside, that both forms of C-TOP reach."""
    shares: dict[str, list[float]] = {"literal": [], "elastic": []}
    heard, listed = [], []
    for seed in range(fleets):
        positions, caps_w = wandering_fleet(8, 150, seed)
        air = air_of(positions[::every], caps_w)
        elastic = ctop_elastic(air, K_MIN, DELTA)
        literal = ctop(positions[::every], CHANNEL, caps_w, SENSITIVITY_W, K_MIN, DELTA)
        for slot in range(len(air.gain)):
            best = optimal_bits(replace(air, gain=air.gain[slot : slot + 1]), K_MIN, DELTA)
            for name, top in (("literal", literal), ("elastic", elastic)):
                shares[name].append(1 - carried_bits(top, air)[slot] / best)
        heard.append((elastic.reach.sum(axis=2) > K_MIN + DELTA).mean())
        degree = elastic.adjacency.sum(axis=2)
        listed.append(((degree >= K_MIN) & (degree <= K_MIN + DELTA)).mean())
    print(f"\nBelow the optimum (mixed-integer, HiGHS), {len(shares['literal'])} slots of 8 UAVs:")
    for name, gaps in shares.items():
        known = np.array(gaps)[np.isfinite(gaps)]
        print(f"  {name}  mean {100 * known.mean():.1f} %, greatest {100 * known.max():.1f} %")
    print(
        f"  elastic lists {K_MIN} to {K_MIN + DELTA} in {100 * np.mean(listed):.1f} % of UAV-slots "
        f"and hears more in {100 * np.mean(heard):.0f} %"
    )


def row(uavs: int, slots: int, repeat: int) -> str:
    positions, caps_w = wandering_fleet(uavs, slots)
    air = (positions, CHANNEL, caps_w, SENSITIVITY_W)
    spend = ([1e9] * uavs, SLOT_S)
    top = ctop(*air, K_MIN, DELTA)
    elastic_air = air_of(positions, caps_w)
    known = {
        "channel": CHANNEL,
        "p_max_w": caps_w,
        "sensitivity_w": SENSITIVITY_W,
        "k_min": K_MIN,
        "delta": DELTA,
    }
    cells = [
        f"{median_ms(lambda: ctop(*air, K_MIN, DELTA), repeat):9.2f}",
        f"{median_ms(lambda: ctop_elastic(elastic_air, K_MIN, DELTA), repeat):9.2f}",
        f"{median_ms(lambda: energy_floor(positions, SLOT_S, **known), repeat):9.2f}",
        f"{median_ms(lambda: a_lmst(*air, *spend, [10.0] * uavs), repeat):9.2f}",
        f"{median_ms(lambda: cpapo(*air, *spend), repeat):9.2f}",
        f"{100 * (top.degree_before_trim > K_MIN + DELTA).mean():8.1f}",
        f"{100 * top.over_degree.mean():8.2f}",
        f"{top.degree_before_trim.mean():8.2f}",
        f"{top.adjacency.sum(axis=2).mean():8.2f}",
    ]
    return f"{uavs:4d} {slots:5d} " + " ".join(cells)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--repeat", type=int, default=9)
    parser.add_argument("--bound", type=int, default=3, help="fleets held against the optimum")
    given = parser.parse_args()
    repeat = given.repeat
    with tempfile.TemporaryDirectory() as cache:
        print(f"first call ever {first_call_s(cache):.1f} s, in a new process later ", end="")
        print(f"{first_call_s(cache):.2f} s\n")
    print(
        "   A     N   C-TOP ms elast. ms  floor ms A-LMST ms  CPAPO ms  above %  stuck % "
        " mean k'   mean k"
    )
    for uavs in (4, 8, 16, 32, 64, 100):
        print(row(uavs, 150, repeat))
    print()
    for slots in (50, 150, 500, 1500):
        print(row(8, slots, repeat))
    print("\nabove: degrees over K_min + δ before trimming; stuck: after it; k', k: degree before,")
    print("after. floor: the least energy, as the route search asks for it.")
    bound(given.bound)


if __name__ == "__main__":
    main()
