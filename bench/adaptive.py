"""Powers re-solved on the poses as flown, beside powers as planned on the desk, in one same air.

    jfto plan config/demo.yaml -o plan.json
    python bench/adaptive.py plan.json [--seeds 20] [--all]

Three pilots fly each condition from the same seeds: `desk` sets the powers of the plan's own
evaluation, `margin` those of a desk that gives every link 0.5 dB through its whole slot, and
`adaptive` is the cores of topology_node and power_node with their default parameters. One
error at a time and all worst together; --all flies the whole grid.
"""

from __future__ import annotations

import argparse
import itertools
import time
from collections.abc import Callable
from dataclasses import astuple, replace
from pathlib import Path

import numpy as np

from jfto.analysis.comparison import compare
from jfto.planning.network import network_of
from jfto_msgs_py.plan_file import read_plan
from jfto_msgs_py.records.air import AirArray
from jfto_msgs_py.records.plan import Plan
from jfto_msgs_py.records.vehicle import VehiclePose
from jfto_planner.plan_trajectory import timed_trajectories
from jfto_power.allocation import PowerProblem, allocate
from jfto_power.core import PowerCore
from jfto_power.energy_account import EnergyAccount
from jfto_power.horizon import HorizonRules
from jfto_power.options import PowerOptions
from jfto_topology.core import TopologyCore, TopologySettings
from jfto_topology.links import Links
from jfto_topology.options import TopologyOptions
from virtual_flight import START_NS, STEPS_PER_SLOT, Errors, Pilot, Score, World, fly

N_DC = 45
POSITIONS_M, TIMES_S, LOSSES_DB = (0.0, 2.0, 5.0), (0.0, 1.0, 3.0), (0.0, 3.0, 6.0)
PILOTS = ("desk", "margin", "adaptive")


class Desk:
    """A schedule as planned, row n from the beginning of slot n on."""

    def __init__(self, plan: Plan, power_w: np.ndarray) -> None:
        self._ids, self._power_w = [uav.id for uav in plan.uavs], power_w
        self._step_s = World.step_s(plan)

    def powers(self, now_ns, _poses_m, _heard):
        """The next row at each slot's beginning."""
        step = round((now_ns - START_NS) / 1e9 / self._step_s)
        if step % STEPS_PER_SLOT:
            return None
        row = self._power_w[step // STEPS_PER_SLOT]
        return dict(zip(self._ids, row.tolist(), strict=True))


class Adaptive:
    """What the graph does: the cores of both nodes, fed with what their topics carry."""

    def __init__(self, plan: Plan) -> None:
        options = TopologyOptions()
        links = replace(links_of(plan), margin_db=options.margin_db)
        slots = plan.slots
        self._topology = TopologyCore(
            TopologySettings(links, slots.count, slots.horizon_s, plan.d_min_m, options)
        )
        reserve = PowerOptions().energy_reserve
        self._power = PowerCore(
            HorizonRules(slots.count, links.channel, plan.radio, reserve),
            EnergyAccount({uav.id: uav.energy_j for uav in plan.uavs}),
        )
        for uav, trajectory in timed_trajectories(plan, START_NS).items():
            for core in (self._topology, self._power):
                core.take_trajectory(uav, trajectory, START_NS)

    def powers(self, now_ns, poses_m, heard):
        """The best powers of a slot as soon as it is due."""
        topology, power = self._topology, self._power
        # A slot begins with the power node's own timer; poses come after it.
        begun = power.step(now_ns)
        topology.take_energy(begun.left_j, now_ns)
        topology.take_gain(AirArray(heard.stamp_ns, heard.uav_ids, heard.gain), now_ns)
        for uav, place in zip(heard.uav_ids, poses_m.tolist(), strict=True):
            pose = VehiclePose(now_ns, tuple(place), 0.0)
            topology.take_pose(uav, pose, now_ns)
            power.take_pose(uav, pose, now_ns)
        solved = topology.step(now_ns).solved
        if solved is None:
            return begun.setpoints_w
        power.take_adjacency(solved.adjacency, now_ns)
        power.take_intervals(solved.intervals, now_ns)
        return begun.setpoints_w | power.step(now_ns).setpoints_w


def links_of(plan: Plan) -> Links:
    network = network_of(plan)
    caps_w = dict(zip([uav.id for uav in plan.uavs], network.p_max_w.tolist(), strict=True))
    return Links(network.channel, caps_w, network.sensitivity_w, plan.k_min, plan.delta)


def desk_with_margin(plan: Plan) -> np.ndarray:
    """Powers (N + 1, A) of a desk that knows no errors but leaves room for some."""
    network, ids = network_of(plan), tuple(uav.id for uav in plan.uavs)
    links = replace(links_of(plan), margin_db=TopologyOptions().margin_db)
    # Beyond the last instant the fleet stays where it is.
    places_m = np.concatenate([network.positions_m, network.positions_m[-1:]])
    left_j = dict(zip(ids, network.energy_j.tolist(), strict=True))
    top, _ = links.topology(ids, places_m, plan.slots.duration_s, left_j)
    limits = (top.p_min_w, top.p_upper_w, network.energy_j, plan.slots.duration_s, plan.radio)
    return allocate(PowerProblem(top.adjacency, network.gain, *limits, ids)).power_w


def conditions(everything: bool) -> list[Errors]:
    if everything:
        return [Errors(*each) for each in itertools.product(POSITIONS_M, TIMES_S, LOSSES_DB)]
    alone = [
        *(Errors(position_m=value) for value in POSITIONS_M),
        *(Errors(time_s=value) for value in TIMES_S[1:]),
        *(Errors(loss_db=value) for value in LOSSES_DB[1:]),
    ]
    return [*alone, Errors(POSITIONS_M[-1], TIMES_S[-1], LOSSES_DB[-1])]


def row(errors: Errors, scores: dict[str, list[Score]]) -> str:
    means = {
        name: np.mean([astuple(score) for score in got], axis=0) for name, got in scores.items()
    }
    cells = []
    for place, (scale, digits) in enumerate(((1, 0), (100, 1), (100, 2), (100, 1), (1, 1))):
        cells.append(" / ".join(f"{scale * means[name][place]:.{digits}f}" for name in PILOTS))
    head = f"{errors.position_m:g} m | {errors.time_s:g} s | {errors.loss_db:g} dB"
    return f"| {head} | {' | '.join(cells)} | {verdict(scores)} |"


def verdict(scores: dict[str, list[Score]]) -> str:
    """What adaptive does worse than desk on the mean, if anything."""
    better_high = {"mbps": "Mb/s", "xi": "ξ"}
    better_low = {"below": "K_min", "apart": "apart", "overdrawn": "overdrawn"}

    def gain(name: str) -> float:
        return float(
            np.mean([getattr(score, name) for score in scores["adaptive"]])
            - np.mean([getattr(score, name) for score in scores["desk"]])
        )

    lost = [text for name, text in better_high.items() if gain(name) < 0]
    lost += [text for name, text in better_low.items() if gain(name) > 0]
    return f"not in {', '.join(lost)}" if lost else "yes"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("plan", type=Path)
    parser.add_argument("--seeds", type=int, default=20)
    parser.add_argument("--all", action="store_true", help="the whole grid of 27")
    arguments = parser.parse_args()
    plan = read_plan(arguments.plan)
    # A short plan counts from its last slot.
    planned = compare(plan, min(N_DC, plan.slots.count)).ours
    margin_w = desk_with_margin(plan)
    pilots: dict[str, Callable[[], Pilot]] = {
        "desk": lambda: Desk(plan, planned.power_w),
        "margin": lambda: Desk(plan, margin_w),
        "adaptive": lambda: Adaptive(plan),
    }
    mbps, xi = planned.linked.mean_throughput_mbps, 100 * planned.linked.connectivity_rate
    print(f"planned: {mbps:.0f} Mb/s, ξ {xi:.1f} %; cells are {' / '.join(PILOTS)}\n")
    print(
        "| position | time | loss | Mb/s | ξ % | UAVs below K_min % | in parts % "
        "| UAVs overdrawn | adaptive wins |"
    )
    print("|---|---|---|---|---|---|---|---|---|")
    for errors in conditions(arguments.all):
        # A loss alone is the same for every seed.
        seeds = arguments.seeds if errors.position_m or errors.time_s else 1
        worlds = [World(plan, errors, seed) for seed in range(seeds)]
        scores = {
            name: [fly(world, make(), N_DC) for world in worlds] for name, make in pilots.items()
        }
        print(row(errors, scores), flush=True)
    print(f"\n{arguments.seeds} seeds each; {time.process_time():.0f} s of processor time")


if __name__ == "__main__":
    main()
