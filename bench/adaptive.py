"""Powers re-solved on the poses as flown, beside powers as planned on the desk, in one same air.

    jfto plan config/demo.yaml -o plan.json
    python bench/adaptive.py plan.json [--seeds 20] [--all]

Three pilots fly each condition from the same seeds: `desk` sets the powers of the plan's own
evaluation, `margin` those of a desk that gives every link 0.5 dB through its whole slot, and
`adaptive` is the library code of topology_node and power_node with their default parameters. One
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
from jfto_msgs_py.plan import Plan
from jfto_msgs_py.plan_file import read_plan
from jfto_msgs_py.vehicle import VehiclePose
from jfto_planner.plan_trajectory import timed_trajectories
from jfto_power.allocation import allocate
from jfto_power.horizon import EnergyBook, plan_horizon
from jfto_power.power_options import PowerOptions
from jfto_topology.horizon import HorizonSettings, TopologyHorizon
from jfto_topology.links import SPREADS, Links
from jfto_topology.options import TopologyOptions
from jfto_world.motion.fleet_prediction import FleetPrediction
from jfto_world.radio import LossEstimate
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
    """What the nodes do, slot by slot: learn the loss, solve the topology, then the powers."""

    def __init__(self, plan: Plan) -> None:
        self._plan, self._links = plan, links_of(plan)
        prediction = FleetPrediction()
        for uav, trajectory in timed_trajectories(plan, START_NS).items():
            prediction.set_trajectory(uav, trajectory)
        settings = HorizonSettings(plan.slots.count, plan.slots.duration_s)
        self._horizon = TopologyHorizon(prediction, self._links, settings)
        self._losses = LossEstimate(self._links.channel)
        self._book = EnergyBook({uav.id: uav.energy_j for uav in plan.uavs}, START_NS)
        self._heard_poses_m: np.ndarray | None = None

    def powers(self, now_ns, poses_m, heard):
        """The best powers of a slot as soon as it is due."""
        horizon, ids = self._horizon, heard.uav_ids
        # Of the last step: its poses are the ones that the levels were measured at.
        at = poses_m if self._heard_poses_m is None else self._heard_poses_m
        self._losses.take(heard.stamp_ns, heard.gain, at)
        self._heard_poses_m = poses_m
        if horizon.slot >= 0 and now_ns < horizon.next_ns(now_ns):
            return None
        for uav, place in zip(ids, poses_m.tolist(), strict=True):
            horizon.prediction.set_pose(uav, VehiclePose(now_ns, tuple(place), 0.0))
        if not horizon.due(now_ns):
            return None
        self._book.advance(now_ns)
        horizon.left_j = self._book.left_j
        horizon.links = replace(
            self._links,
            loss_db=self._losses.loss_db,
            margin_db=TopologyOptions().margin_db + SPREADS * self._losses.spread_db,
        )
        found = horizon.solve(now_ns)
        instants_ns = found.adjacency.horizon.instants_ns
        best = plan_horizon(
            found.adjacency,
            found.intervals,
            horizon.prediction.positions(found.adjacency.uav_ids, instants_ns),
            self._book.left_j,
            slot_count=self._plan.slots.count,
            channel=self._links.channel,
            radio=self._plan.radio,
            reserve=PowerOptions().energy_reserve,
        ).schedule
        powers = dict(zip(best.uav_ids, best.power_w[0].tolist(), strict=True))
        self._book.set_powers(now_ns, powers)
        return powers


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
    return allocate(top.adjacency, network.gain, *limits, names=ids).power_w


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
    planned = compare(plan, N_DC).ours
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
