"""C-TOP beside the baselines on fleets that wander, each with and without the exact powers.

    python bench/comparison.py [--fleets 12]

Means over fleets of 8 UAVs, 150 slots of 3 s, 2 km × 2 km, budgets of 150 to 200 J. These are not
planned routes: `jfto evaluate` compares on those.
"""

from __future__ import annotations

import argparse
from collections import defaultdict

import numpy as np

from jfto_msgs_py.records.radio import Radio
from jfto_msgs_py.units import dbm_to_w
from jfto_power.allocation import PowerProblem, allocate
from jfto_power.shortage import EnergyShortage
from jfto_topology.algorithms.cpapo import cpapo
from jfto_topology.algorithms.ctop import ctop
from jfto_topology.algorithms.intervals import kept_intervals
from jfto_topology.algorithms.lmst import a_lmst
from jfto_topology.algorithms.mtp import mtp
from jfto_topology.metrics import (
    average_hops,
    connectivity_rate,
    energy_used,
    slot_throughput,
)
from jfto_world.radio import degrees, make_channel, pairwise_distances
from random_fleet import wandering_fleet

UAVS, SLOTS, SLOT_S, LOST_AT = 8, 150, 3.0, 45
K_MIN, DELTA = 2, 2
RADIO = Radio()
CHANNEL = make_channel(RADIO)
SENSITIVITY_W = dbm_to_w(RADIO.sensitivity_dbm)


def compare(seed: int, rows: dict[str, list]) -> None:
    positions, caps_w = wandering_fleet(UAVS, SLOTS, seed)
    energy = np.random.default_rng(seed).uniform(150, 200, UAVS)
    air = (positions, CHANNEL, caps_w, SENSITIVITY_W)
    gain = CHANNEL.gain(pairwise_distances(positions))

    def note(name, adjacency, power_w, on_air):
        degree = degrees(adjacency)
        rows[name].append(
            (
                slot_throughput(adjacency, gain, power_w, RADIO)[1:].mean() / 1e6,
                100 * connectivity_rate(adjacency, LOST_AT, on_air),
                average_hops(adjacency),
                degree.mean(),
                100 * (degree < K_MIN).mean(),
                100 * (degree > K_MIN + DELTA).mean(),
                energy_used(power_w, SLOT_S).mean(),
                on_air.all(),
            )
        )

    def note_exact(name, adjacency, low_w, upper_w):
        try:
            problem = PowerProblem(adjacency, gain, low_w, upper_w, energy, SLOT_S, RADIO)
            best = allocate(problem)
        except EnergyShortage as shortage:
            print(f"fleet {seed}, {name}: {shortage}")
            return
        note(name, adjacency, best.power_w, np.ones(best.power_w.shape, dtype=bool))

    top = ctop(*air, K_MIN, DELTA)
    note_exact("C-TOP", top.adjacency, top.p_min_w, top.p_upper_w)
    note("MTP", *fields(mtp(*air, energy, SLOT_S)))
    for name, played in (
        ("A-LMST", a_lmst(*air, energy, SLOT_S, np.full(UAVS, 10.0))),
        ("CPAPO", cpapo(*air, energy, SLOT_S)),
    ):
        note(name, *fields(played))
        if played.on_air.all():
            low_w, upper_w = kept_intervals(played.adjacency, *air)
            note_exact(f"{name} + power", played.adjacency, low_w, upper_w)


def fields(played):
    return played.adjacency, played.power_w, played.on_air


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--fleets", type=int, default=12)
    fleets = parser.parse_args().fleets
    rows: dict[str, list] = defaultdict(list)
    for seed in range(fleets):
        compare(seed, rows)
    print(
        "algorithm        fleets    Mb/s   ratio    ξ %   hops  degree  <K_min %  >K_min+δ %"
        "   joules  all waypoints %"
    )
    ours = np.mean([row[0] for row in rows["C-TOP"]])
    for name, values in rows.items():
        rate, xi, hops, degree, below, above, joules, done = np.mean(values, axis=0)
        print(
            f"{name:17s} {len(values):5d} {rate:7.0f} {ours / rate:7.2f} {xi:6.1f} {hops:6.2f} "
            f"{degree:7.2f} {below:9.1f} {above:11.1f} {joules:8.1f} {100 * done:8.0f}"
        )


if __name__ == "__main__":
    main()
