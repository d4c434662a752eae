"""The search against PyVRP, which knows nothing of the radio.

    python bench/routing.py [--scene config/wanglang.yaml] [--seeds 5] [--pyvrp-seconds 60]
                            [--set radio.gain_tx_dbi=0 …] [--no-energy] [--moves M] [--starts K]

PyVRP solves the same open routes (a dummy end depot, reached at no cost), waypoints, distances,
leg times and T_a,max as shift durations, in centimetres and hundredths of a second, once per seed;
the best of its runs is the reference. It has no neighbour rule, no separation, no energy, so its
routes are no bound of ours from either side: both are heuristics. Each plan of ours is checked by
the independent certificate. Exit status 1 if one is not clean or longer than `--target` times the
reference.
"""

from __future__ import annotations

import argparse
import math
import time
from collections import Counter
from dataclasses import replace

import numpy as np
from pyvrp import Model
from pyvrp.stop import MaxRuntime

from jfto.planning.problem import plan_uavs, routing_problem
from jfto.planning.scenario_file import load_scenario
from jfto.planning.survey import Survey, survey
from jfto_msgs_py.errors import InfeasibleError
from jfto_msgs_py.plan_file import rounded
from jfto_msgs_py.records.certificate import Certificate
from jfto_msgs_py.scenario import Scenario
from jfto_planner.routing import (
    PlanTerms,
    RoutingProblem,
    SearchSettings,
    build_plan,
    certify,
    search,
)
from jfto_planner.routing.assess import Routes

SCALE = 100
# Stands for "no such edge"; far above any route and far below overflow.
NO_EDGE = 10**9


def radio_free_length_m(problem: RoutingProblem, seconds: float, seed: int) -> tuple[float, int]:
    """Length of PyVRP's best routes (inf: none found) and its number of iterations."""
    model = Model()
    points = np.concatenate([problem.waypoints_m, problem.starts_m])
    count = problem.waypoint_count
    steps = points[:, None, :] - points[None, :, :]
    distance = np.rint(np.sqrt((steps**2).sum(axis=-1)) * SCALE).astype(int).tolist()
    places = [model.add_location(float(x), float(y)) for x, y, _ in points]
    nowhere = model.add_location(0.0, 0.0)
    for place in places[:count]:
        model.add_client(place)
    pads = [model.add_depot(place) for place in places[count:]]
    end = model.add_depot(nowhere)
    for uav, limits in enumerate(problem.limits):
        profile = model.add_profile()
        legs = problem.time_model.leg_matrix(points, limits)
        duration = np.ceil(legs * SCALE).astype(int).tolist()
        for i in [*range(count), count + uav]:
            for j in range(count):
                if i != j:
                    model.add_edge(places[i], places[j], distance[i][j], duration[i][j], profile)
            model.add_edge(places[i], nowhere, 0, 0, profile)
        model.add_vehicle_type(
            start_depot=pads[uav],
            end_depot=end,
            shift_duration=int(problem.latest_arrival_s[uav] * SCALE),
            profile=profile,
        )
    result = model.solve(MaxRuntime(seconds), seed=seed, display=False, missing_value=NO_EDGE)
    length = result.cost() / SCALE if result.is_feasible() else math.inf
    return length, result.num_iterations


def certificate_of(
    scenario: Scenario, found: Survey, problem: RoutingProblem, routes: Routes
) -> Certificate:
    """Certificate of the plan that routes amount to, as it would be read back from its file."""
    plan = build_plan(
        routes,
        PlanTerms(
            waypoints=found.waypoints,
            uavs=plan_uavs(scenario, found, problem.starts_m),
            slot_count=problem.slot_count,
            horizon_s=problem.horizon_s,
            k_min=problem.k_min,
            delta=scenario.network.delta,
            d_min_m=problem.d_min_m,
            length_max_m=problem.length_max_m,
            radio=scenario.radio,
            origin=found.dem.origin,
            scenario_hash=scenario.scenario_hash(),
            seed=0,
        ),
    )
    return certify(rounded(plan), problem.energy_floor)


def options() -> argparse.Namespace:
    """Command line of this benchmark."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--scene", default="config/wanglang.yaml")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE")
    parser.add_argument("--seeds", type=int, default=5)
    parser.add_argument("--pyvrp-seconds", type=float, default=60.0)
    parser.add_argument("--pyvrp-runs", type=int, help="runs of PyVRP; default one per seed")
    parser.add_argument("--reference-m", type=float, help="a known length in place of PyVRP")
    parser.add_argument("--no-energy", action="store_true", help="leave the energy budget out")
    parser.add_argument("--moves", type=int, default=SearchSettings().moves)
    parser.add_argument("--starts", type=int, default=SearchSettings().starts)
    parser.add_argument("--target", type=float, default=1.03)
    return parser.parse_args()


def reference_m(problem: RoutingProblem, chosen: argparse.Namespace) -> float:
    """Best radio-free length in metres."""
    if chosen.reference_m:
        return float(chosen.reference_m)
    lengths = []
    for seed in range(chosen.pyvrp_runs or chosen.seeds):
        length, iterations = radio_free_length_m(problem, chosen.pyvrp_seconds, seed)
        print(f"PyVRP seed {seed}: {length:9.1f} m, {iterations} iterations", flush=True)
        lengths.append(length)
    return min(lengths)


def main() -> int:
    """Print one row per seed; the status is 1 if a target is missed, 3 if no start is possible."""
    chosen = options()
    loaded = load_scenario(chosen.scene, chosen.set)
    found = survey(loaded)
    try:
        problem = routing_problem(loaded.scenario, found)
    except InfeasibleError as error:
        print(f"infeasible before any search: {error}")
        return 3
    if chosen.no_energy:
        problem = replace(problem, energy_j=None, energy_floor=None)
    print(
        f"{chosen.scene}: {problem.uav_count} UAVs, {problem.waypoint_count} waypoints, "
        f"K_min {problem.k_min}, reach {problem.reach_m.min():.0f}…{problem.reach_m.max():.0f} m"
    )
    reference = reference_m(problem, chosen)
    settings = SearchSettings(moves=chosen.moves, starts=chosen.starts)
    warm_up = SearchSettings(moves=1, starts=1)
    begun = time.perf_counter()
    search(problem, warm_up, seed=0)
    print(f"first stretch, compilation or cache included: {time.perf_counter() - begun:.1f} s")
    print("seed  length m   ratio  clean  search s  moves/s  violations")
    missed = False
    for seed in range(chosen.seeds):
        result = search(problem, settings, seed=seed)
        certificate = certificate_of(loaded.scenario, found, problem, result.routes)
        ratio = result.length_m / reference
        missed |= not certificate.clean or ratio > chosen.target
        kinds = Counter(violation.kind for violation in certificate.violations)
        clean = "yes" if certificate.clean else "NO"
        print(
            f"{seed:4d} {result.length_m:9.1f} {ratio:7.4f} {clean:>6s} "
            f"{result.seconds:9.1f} {result.moves / result.seconds:8.0f}  "
            + ", ".join(f"{count} {kind}" for kind, count in sorted(kinds.items())),
            flush=True,
        )
    return int(missed)


if __name__ == "__main__":
    raise SystemExit(main())
