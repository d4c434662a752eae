"""Second stage: who flies where, as a certified plan."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from jfto.console.progress import Watcher
from jfto.planning.flight import Flight, ends_s, expected_s, flight_of, tightened
from jfto.planning.network import energy_floor_of
from jfto.planning.speeds import fleet_limits, speed_notes
from jfto.planning.survey import Survey
from jfto_msgs_py.certificate import Certificate
from jfto_msgs_py.errors import InputError, PlanError
from jfto_msgs_py.plan import Plan, Uav, Vector
from jfto_msgs_py.plan_file import read_plan, rounded, rounded_record, rounded_waypoint
from jfto_msgs_py.scenario import Scenario
from jfto_msgs_py.types import Array
from jfto_msgs_py.units import dbm_to_w
from jfto_planner.low_legs import low_legs
from jfto_planner.methods import SEARCH, solve
from jfto_planner.routing import (
    Estimated,
    RoutingProblem,
    SearchSettings,
    build_plan,
    calibrated,
    certify,
    search,
)
from jfto_planner.routing.assess import Routes
from jfto_planner.routing.certificate_ground import GroundRule
from jfto_planner.starts import check_starts, choose_starts, place_pads
from jfto_world.motion import MotionLimits
from jfto_world.radio import make_channel

# A plan that breaks a rule once it is timed as flown goes back to the search, so many times in all;
# a later search starts from the routes it has, and tries so much fewer moves.
ROUNDS, LATER_SHARE = 4, 4
# Leg estimates are corrected by the routes of a search that tries so much fewer moves.
CALIBRATION_SHARE = 16
# Of the height of lift-off, what a first leg must keep above the ground until it is high enough.
START_SHARE = 0.5


@dataclass(frozen=True)
class Planned:
    """A certified plan; `interrupted` says that the search was stopped before its budget.

    `estimate_s` is the makespan that the search expected of its routes, `learned` what a learned
    method and the search alone found, in words.
    """

    plan: Plan
    interrupted: bool
    estimate_s: float
    learned: str = ""

    @property
    def faults(self) -> int:
        """How many violations the certificate has."""
        return len(self.certificate.violations)

    @property
    def certificate(self) -> Certificate:
        """The plan's certificate."""
        assert self.plan.certificate is not None
        return self.plan.certificate


def plan_routes(
    scenario: Scenario, found: Survey, watcher: Watcher, warm_start: Plan | None = None
) -> Planned:
    """Search routes over the waypoints and certify them; `warm_start` is a plan to improve.

    Raises InfeasibleError before any search where the starts cannot satisfy the neighbour rule or
    the wind leaves no speed, PlanError where `warm_start` is for other waypoints or another fleet.
    """
    watcher.begin("routes", "choosing starting points")
    for note in speed_notes(scenario):
        watcher.warn(note)
    flight = flight_of(scenario)
    if flight.estimated:
        # A flight in steps may come out a step later for a point a nanometre off.
        found = replace(found, waypoints=tuple(map(rounded_waypoint, found.waypoints)))
    problem = routing_problem(scenario, found)
    ground = _ground_rule(scenario, found)
    warm = None if warm_start is None else _warm_routes(warm_start, found, problem)
    watcher.begin("routes", "comparing leg times with flights")
    problem, stopped, warm = _calibrated(scenario, found, problem, flight, warm)
    best: Planned | None = None
    learned = ""
    share = scenario.search.moves if stopped else 1
    for round_ in range(ROUNDS):
        watcher.begin("routes", "searching" if round_ == 0 else f"searching, round {round_ + 1}")
        solved = solve(
            problem,
            _settings(scenario, share if round_ == 0 else LATER_SHARE),
            # Later rounds repair what they have; there is nothing to learn from a policy there.
            method=scenario.search.method if round_ == 0 else SEARCH,
            seed=scenario.search.seed,
            warm_start=warm,
            progress=watcher.advance,
        )
        result, learned = solved.best, learned or solved.in_words()
        watcher.begin("routes", "checking with independent code")
        plan = _as_flown(scenario, found, problem, flight, result.routes)
        plan = replace(plan, certificate=certify_plan(plan, ground))
        stopped |= result.stopped_by == "user"
        estimate_s = float(expected_s(problem, result.routes).max())
        planned = Planned(plan, stopped, estimate_s, learned)
        if best is None or planned.faults < best.faults:
            best = planned
        # Where the search judges by the very times that the plan has, it knows all but what happens
        # between its instants.
        if is_clean(plan) or not result.feasible or stopped or _known(flight, plan):
            break
        problem, warm = tightened(problem, plan), result.routes
    assert best is not None
    good = is_clean(best.plan)
    watcher.end("routes", f"{best.plan.total_length_m / 1000:.2f} km", _proof(best), good=good)
    return best


def _known(flight: Flight, plan: Plan) -> bool:
    assert plan.certificate is not None
    kinds = {violation.kind for violation in plan.certificate.violations}
    return flight.exact and (not flight.estimated or kinds != {"separation"})


def _calibrated(
    scenario: Scenario,
    found: Survey,
    problem: RoutingProblem,
    flight: Flight,
    warm: Routes | None,
) -> tuple[RoutingProblem, bool, Routes | None]:
    """The problem with leg estimates that are right on average over routes of a short search.

    Also whether the user stopped it, and the routes to start from.
    """
    if not flight.estimated:
        return problem, False, warm
    rough = replace(problem, time_model=Estimated(problem.time_model))
    settings = _settings(scenario, CALIBRATION_SHARE)
    result = search(rough, settings, seed=scenario.search.seed, warm_start=warm)
    plan = _as_flown(scenario, found, problem, flight, result.routes)
    speeds = np.array([limits.speed_mps for limits in problem.limits])
    expected = expected_s(rough, result.routes)
    corrected = calibrated(flight.time_model, speeds, ends_s(plan), expected)
    stopped = result.stopped_by == "user"
    return (
        replace(problem, time_model=flight.model(corrected)),
        stopped,
        result.routes if stopped else warm,
    )


def _as_flown(
    scenario: Scenario, found: Survey, problem: RoutingProblem, flight: Flight, routes: Routes
) -> Plan:
    """Plan of routes as they will be flown, exactly as it will be read back."""
    mission, network = scenario.mission, scenario.network
    return rounded(
        build_plan(
            routes,
            waypoints=found.waypoints,
            uavs=plan_uavs(scenario, problem.starts_m),
            slot_count=mission.slot_count,
            horizon_s=mission.horizon_s or None,
            k_min=network.k_min,
            delta=network.delta,
            d_min_m=mission.d_min_m,
            length_max_m=mission.length_max_m,
            radio=scenario.radio.record(),
            origin=found.dem.origin,
            scenario_hash=scenario.scenario_hash(),
            seed=scenario.search.seed,
            time_model=flight.name,
            time_parameters=flight.parameters,
            trajectories=flight.trajectories(problem, routes, scenario.fleet.ids, found.dem.height),
        )
    )


def certify_plan(plan: Plan, ground: GroundRule | None = None) -> Certificate:
    """Check a plan from its positions, energy included, and height where the ground is known."""
    floor = energy_floor_of(
        plan.radio, tuple(uav.p_max_dbm for uav in plan.uavs), plan.k_min, plan.delta
    )
    return certify(plan, energy_floor=floor, ground=ground)


def read_and_certify(path: Path) -> Plan:
    """Plan of a file with a certificate made anew; raises PlanError that names the file."""
    plan = read_plan(path)
    try:
        return replace(plan, certificate=certify_plan(plan))
    except InputError as error:
        raise PlanError(f"{path}: {error}") from None


def is_clean(plan: Plan) -> bool:
    """Whether the plan has been checked and nothing was found."""
    return plan.certificate is not None and plan.certificate.clean


def routing_problem(scenario: Scenario, found: Survey) -> RoutingProblem:
    """The routing problem of a scenario; raises InfeasibleError where its starts cannot serve."""
    fleet, mission, network = scenario.fleet, scenario.mission, scenario.network
    radio = scenario.radio.record()
    channel = make_channel(radio)
    reach = channel.reach(
        dbm_to_w(np.array(fleet.p_max_dbm)), float(dbm_to_w(radio.sensitivity_dbm))
    )
    waypoints = np.array([waypoint.position_m for waypoint in found.waypoints])
    flight = flight_of(scenario)
    pads = _pads(scenario, found, waypoints, reach)
    if flight.estimated:
        pads = np.array(rounded_record(pads))
    check_starts(pads, reach, network.k_min, mission.d_min_m, fleet.ids)
    return RoutingProblem(
        waypoints_m=waypoints,
        starts_m=pads,
        limits=tuple(
            MotionLimits(uav.speed_mps, uav.climb_mps, uav.descent_mps)
            for uav in plan_uavs(scenario, pads)
        ),
        time_model=flight.model(),
        t_max_s=np.array(fleet.t_max_s),
        reach_m=reach,
        k_min=network.k_min,
        d_min_m=mission.d_min_m,
        length_max_m=mission.length_max_m,
        slot_count=mission.slot_count,
        horizon_s=mission.horizon_s or None,
        energy_j=np.array(fleet.energy_j),
        energy_floor=energy_floor_of(radio, fleet.p_max_dbm, network.k_min, network.delta),
        path_loss_exponent=channel.exponent,
        closed_legs=_closed_legs(scenario, found, waypoints, pads),
    )


def _ground_rule(scenario: Scenario, found: Survey) -> GroundRule | None:
    """What height above ground the plan must keep; waypoints that are lower are let be."""
    wanted = scenario.trajectory
    if wanted.mode == "straight":
        return None
    waypoints = np.array([waypoint.position_m for waypoint in found.waypoints])
    ground = found.dem.height(waypoints[:, 0], waypoints[:, 1])
    clearance_m = min(wanted.clearance_m, float(np.min(waypoints[:, 2] - ground)))
    start_m = wanted.takeoff_m if wanted.mode == "waypoints" else clearance_m
    return GroundRule(found.dem.height, clearance_m, START_SHARE * min(start_m, clearance_m))


def _closed_legs(
    scenario: Scenario, found: Survey, waypoints: Array, pads: Array
) -> NDArray[np.bool_] | None:
    """Legs of missions that pass too near the ground; curves get via points instead."""
    rule = _ground_rule(scenario, found)
    if rule is None or scenario.trajectory.mode != "waypoints":
        return None
    above = pads + np.array([0.0, 0.0, scenario.trajectory.takeoff_m])
    return low_legs(waypoints, above, rule.height, rule.clearance_m, rule.start_clearance_m)


def _pads(scenario: Scenario, found: Survey, waypoints: Array, reach: Array) -> Array:
    """Pad of each UAV (A, 3): on the given starting points in turn, or chosen."""
    given = np.array(scenario.starts.positions_m).reshape(-1, 2)
    d_min_m = scenario.mission.d_min_m
    if len(given):
        start_of = np.arange(scenario.fleet.count) % len(given)
        return place_pads(given, start_of, d_min_m, found.dem.height)
    return choose_starts(
        waypoints,
        min(scenario.starts.count, len(waypoints)),
        reach,
        scenario.network.k_min,
        d_min_m,
        found.dem.height,
        # The instance must not change with the seed of the search.
        np.random.default_rng(scenario.waypoints.seed),
    )


def _settings(scenario: Scenario, share: int = 1) -> SearchSettings:
    wanted = scenario.search
    return SearchSettings(
        moves=max(1, wanted.moves // share),
        starts=wanted.starts,
        time_limit_s=wanted.time_limit_s / share if wanted.time_limit_s else None,
        workers=wanted.workers or None,
    )


def _warm_routes(plan: Plan, found: Survey, problem: RoutingProblem) -> tuple[tuple[int, ...], ...]:
    """Routes of an earlier plan as indices into the waypoints."""
    if len(plan.uavs) != problem.uav_count:
        raise PlanError(
            f"The warm start has {len(plan.uavs)} UAVs, the scenario {problem.uav_count}. "
            "Start from a plan for the same fleet."
        )
    index = {waypoint.id: place for place, waypoint in enumerate(found.waypoints)}
    unknown = {waypoint.id for waypoint in plan.waypoints} ^ set(index)
    if unknown:
        raise PlanError(
            f"The warm start is for other waypoints: {len(unknown)} ids differ. "
            "Start from a plan for the same scenario."
        )
    return tuple(tuple(index[number] for number in route.waypoint_ids) for route in plan.routes)


def plan_uavs(scenario: Scenario, pads_m: Array) -> tuple[Uav, ...]:
    """Records of a fleet on its pads (A, 3)."""
    fleet = scenario.fleet
    return tuple(
        Uav(
            id=fleet.ids[uav],
            p_max_dbm=fleet.p_max_dbm[uav],
            energy_j=fleet.energy_j[uav],
            t_max_s=fleet.t_max_s[uav],
            # As in the plan file, since times follow from them.
            speed_mps=rounded_record(limits.speed_mps),
            climb_mps=rounded_record(limits.climb_mps),
            descent_mps=rounded_record(limits.descent_mps),
            start_m=_vector(pads_m[uav]),
        )
        for uav, limits in enumerate(fleet_limits(scenario))
    )


def _vector(point: Array) -> Vector:
    return float(point[0]), float(point[1]), float(point[2])


def _proof(planned: Planned) -> str:
    certificate = planned.certificate
    text = f"{certificate.slot_violations} of {certificate.slot_checks} slot checks violated"
    if math.isfinite(certificate.worst_margin_db):
        text += (
            f", margin ≥ {certificate.worst_margin_db:.1f} dB ({certificate.worst_margin_uav}, "
            f"slot {certificate.worst_margin_slot:g})"
        )
    text += ", stopped early" if planned.interrupted else ""
    return f"{planned.learned}; {text}" if planned.learned else text
