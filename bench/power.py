"""The exact power allocation beside cvxpy + Clarabel, in the same run.

    python bench/power.py [--repeat 5]

Times are medians of repeated runs after a first one that compiles; the general solver is compiled
once per shape and only given new parameters. Budgets lie between the floor and full power.
"""

from __future__ import annotations

import argparse
import statistics
import time

import numpy as np

from jfto_msgs_py.records.radio import Radio
from jfto_msgs_py.units import dbm_to_w
from jfto_power.allocation import PowerProblem, allocate
from jfto_power.kkt import kkt_residual, objective_bps
from jfto_power.reference import ReferenceAllocator
from jfto_topology.algorithms.ctop import ctop
from jfto_world.radio import make_channel, pairwise_distances
from random_fleet import wandering_fleet

SLOT_S = 3.0


def case(uavs: int, slots: int, reading: str):
    radio = Radio(noise_reading=reading)
    channel = make_channel(radio)
    positions, caps_w = wandering_fleet(uavs, slots)
    top = ctop(positions, channel, caps_w, dbm_to_w(radio.sensitivity_dbm), 2, 2)
    floor = top.p_min_w[1:].sum(axis=0)
    full = top.p_upper_w[1:].sum(axis=0)
    share = np.random.default_rng(0).uniform(0.1, 0.9, uavs)
    energy = (floor + share * (full - floor)) * SLOT_S
    gain = channel.gain(pairwise_distances(positions))
    return PowerProblem(top.adjacency, gain, top.p_min_w, top.p_upper_w, energy, SLOT_S, radio)


def timed_ms(action, repeat: int):
    start = time.perf_counter()
    result = action()
    first = time.perf_counter() - start
    times = []
    for _ in range(repeat):
        start = time.perf_counter()
        result = action()
        times.append(time.perf_counter() - start)
    return result, 1e3 * first, 1e3 * statistics.median(times)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--repeat", type=int, default=5)
    repeat = parser.parse_args().repeat
    print(
        "noise      A     N   exact ms        KKT | Clarabel ms  (compile ms)   faster  objective"
    )
    for reading in ("total", "per_hertz"):
        for uavs, slots in ((4, 50), (8, 150), (100, 1000)):
            problem = case(uavs, slots, reading)
            linked, gain, radio = problem.adjacency, problem.gain, problem.radio
            best, _, exact_ms = timed_ms(lambda p=problem: allocate(p), repeat)
            residual = kkt_residual(problem, best.power_w, best.multiplier)
            line = f"{reading:9s} {uavs:3d} {slots:5d} {exact_ms:10.3f} {residual:10.1e} |"
            if uavs < 100:
                solver = ReferenceAllocator()
                general, first, ms = timed_ms(lambda p=problem, s=solver: s.solve(p), repeat)
                ours = objective_bps(linked, gain, best.power_w, radio)
                theirs = objective_bps(linked, gain, general, radio)
                line += f" {ms:11.1f} {first:13.0f} {ms / exact_ms:7.0f}x {ours / theirs - 1:10.1e}"
            print(line)


if __name__ == "__main__":
    main()
