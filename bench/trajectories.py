"""Plans timed as they are flown: is the certificate clean, and how near was the search's estimate?

    python bench/trajectories.py [--scene config/wanglang.yaml] [--mode waypoints guided]
                                 [--seeds 5] [--set key=value …]

Prints, per mode and seed: the certificate, length, makespan, UAVs with waypoints, the makespan that
the leg estimate gives for the same routes, and the processor and wall time of smoothing or flying
all routes once more, compiled already. Exit status 1 if a certificate is not clean.
"""

from __future__ import annotations

import argparse
import time

from jfto.planning.flight import flight_of
from jfto.planning.problem import routing_problem
from jfto.planning.routes import Planned, plan_routes
from jfto.planning.scenario_file import load_scenario
from jfto.planning.survey import survey
from jfto_planner.routing.assess import route_points


def main() -> int:
    """Run the benchmark."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--scene", default="config/wanglang.yaml")
    parser.add_argument("--mode", nargs="+", default=["waypoints", "guided"])
    parser.add_argument("--seeds", type=int, default=5)
    parser.add_argument("--set", action="append", default=[], dest="overrides")
    options = parser.parse_args()
    failed = 0
    found = survey(load_scenario(options.scene, options.overrides))
    for mode in options.mode:
        for seed in range(options.seeds):
            overrides = [f"trajectory.mode={mode}", *options.overrides, f"search.seed={seed}"]
            scenario = load_scenario(options.scene, overrides).scenario
            begun = time.perf_counter()
            planned = plan_routes(scenario, found)
            wall_s = time.perf_counter() - begun
            plan = planned.plan
            problem = routing_problem(scenario, found)
            index = {waypoint.id: place for place, waypoint in enumerate(found.waypoints)}
            routes = tuple(tuple(index[i] for i in route.waypoint_ids) for route in plan.routes)
            timing = _timing(scenario, found, problem, routes)
            print(f"{mode:<9} seed {seed}: {_facts(planned)}, {timing}, "
                  f"all in {wall_s:.0f} s", flush=True)  # fmt: skip
            failed += not plan.clean
    return int(failed > 0)


def _facts(planned: Planned) -> str:
    plan = planned.plan
    ends = [max(route.arrival_s, default=0.0) for route in plan.routes]
    certificate = plan.certificate
    assert certificate is not None
    verdict = "clean" if certificate.clean else f"{len(certificate.violations)} violations"
    if not certificate.clean:
        verdict += f" ({certificate.violations[0].message})"
    return (
        f"{verdict}, {plan.total_length_m / 1e3:.2f} km, makespan {max(ends):.1f} s, estimate "
        f"{100 * (planned.estimate_s / max(ends) - 1):+.1f} %, "
        f"{sum(bool(route.waypoint_ids) for route in plan.routes)} UAVs used"
    )


def _timing(scenario, found, problem, routes) -> str:
    flight = flight_of(scenario)
    wall, spent = time.perf_counter(), time.process_time()
    if flight.rules is not None:
        flight.trajectories(problem, routes, scenario.fleet.ids, found.dem.height)
    else:
        for a, (route, limits) in enumerate(zip(routes, problem.limits, strict=True)):
            # Moved by a millimetre, so that nothing is remembered.
            flight.time_model.arrivals(route_points(problem, a, route) + 1e-3, limits)
    return (
        f"timed in {time.perf_counter() - wall:.2f} s wall, {time.process_time() - spent:.2f} s CPU"
    )


if __name__ == "__main__":
    raise SystemExit(main())
