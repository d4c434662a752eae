"""Second stage: who flies where, as a certified plan."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from jfto import words
from jfto.console.progress import SILENT, Progress
from jfto.planning.flight import Flight, ends_s, expected_s, flight_of, keeping_out, tightened
from jfto.planning.network import energy_floor_of, ground_stations
from jfto.planning.problem import (
    free_space,
    ground_rule,
    home_ground,
    home_rules,
    plan_uavs,
    routing_problem,
)
from jfto.planning.speeds import planned_wind_mps, speed_notes
from jfto.planning.survey import Survey
from jfto_msgs_py.errors import InputError, PlanError
from jfto_msgs_py.plan_file import read_plan, rounded, rounded_waypoint
from jfto_msgs_py.records.certificate import Certificate
from jfto_msgs_py.records.plan import Plan
from jfto_msgs_py.scenario import Scenario
from jfto_planner.home import with_ways_home
from jfto_planner.methods import SEARCH, solve
from jfto_planner.routing import (
    Estimated,
    PlanTerms,
    RoutingProblem,
    SearchResult,
    SearchSettings,
    build_plan,
    calibrated,
    certify,
    search,
    with_passed,
)
from jfto_planner.routing.assess import Routes
from jfto_planner.routing.certificate import GroundRule
from jfto_planner.routing.certificate.mission_size import require_missions_to_hold

# A plan that breaks a rule once it is timed as flown goes back to the search, so many times in all;
# a later search starts from the routes it has, and tries so much fewer moves.
ROUNDS, LATER_SHARE = 4, 4
# Leg estimates are corrected by the routes of a search that tries so much fewer moves.
CALIBRATION_SHARE = 16
# Rules for the whole flight, ways home included, of which the search knows the arrivals only.
BATTERY_KINDS = {"battery", "endurance"}


@dataclass(frozen=True)
class Planned:
    """A certified plan; `interrupted` says that the search was stopped before its budget.

    `problem` is what the search solved last and `result` what it found, `estimate_s` the makespan
    that it expected of its routes, `learned` what a learned method and the search alone found, in
    words.
    """

    plan: Plan
    interrupted: bool
    problem: RoutingProblem
    result: SearchResult
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
    scenario: Scenario, found: Survey, progress: Progress = SILENT, warm_start: Plan | None = None
) -> Planned:
    """Search routes over the waypoints and certify them; `warm_start` is a plan to improve.

    Raises InfeasibleError before any search where the starts cannot satisfy the neighbour rule, the
    waypoints do not fit into missions or the wind leaves no speed, PlanError where `warm_start` is
    for other waypoints or another fleet.
    """
    progress.begin("routes", "choosing starting points")
    for note in speed_notes(scenario):
        progress.warn(note)
    fleet, trigger = scenario.fleet, scenario.coverage.trigger
    require_missions_to_hold(found.waypoints, fleet.count, fleet.mission_items, trigger)
    flight = keeping_out(flight_of(scenario), free_space(scenario, found))
    if flight.estimated:
        # A flight in steps may come out a step later for a point a nanometre off.
        found = replace(found, waypoints=tuple(map(rounded_waypoint, found.waypoints)))
    problem = routing_problem(scenario, found)
    ground = ground_rule(scenario, found.waypoints, found.dem)
    warm = None if warm_start is None else _warm_routes(warm_start, found, problem)
    progress.begin("routes", "comparing leg times with flights")
    problem, stopped, warm = _calibrated(scenario, found, problem, flight, warm)
    best: Planned | None = None
    learned = ""
    share = scenario.search.moves if stopped else 1
    for round_ in range(ROUNDS):
        progress.begin("routes", "searching" if round_ == 0 else f"searching, round {round_ + 1}")
        solved = solve(
            problem,
            _settings(scenario, share if round_ == 0 else LATER_SHARE),
            # Later rounds repair what they have; there is nothing to learn from a policy there.
            method=scenario.search.method if round_ == 0 else SEARCH,
            seed=scenario.search.seed,
            warm_start=warm,
            progress=progress.advance,
        )
        result, learned = solved.best, learned or solved.in_words()
        progress.begin("routes", "checking with independent code")
        plan = _as_flown(scenario, found, problem, flight, result.routes)
        plan = rounded(with_ways_home(plan, home_rules(scenario, found)))
        plan = replace(
            plan, certificate=certify_plan(plan, ground, home_ground(scenario, found.dem))
        )
        stopped |= result.stopped_by == "user"
        estimate_s = float(expected_s(problem, result.routes).max())
        planned = Planned(plan, stopped, problem, result, estimate_s, learned)
        if best is None or planned.faults < best.faults:
            best = planned
        # Where the search judges by the very times that the plan has, it knows all but what happens
        # between its instants.
        if plan.clean or not result.feasible or stopped or _known(flight, plan):
            break
        problem, warm = tightened(problem, plan), result.routes
    assert best is not None
    _tell(best, progress)
    return best


def _tell(best: Planned, progress: Progress) -> None:
    if note := trigger_note(best.plan):
        progress.warn(note)
    good = best.plan.clean
    progress.end("routes", f"{best.plan.total_length_m / 1000:.2f} km", _proof(best), good=good)
    if fence := words.fence(best.plan):
        kept = not any(v.kind in ("keep_out", "keep_in") for v in best.certificate.violations)
        progress.end("fence", "kept" if kept else "broken", fence, good=kept)
    progress.end("way home", f"{best.plan.landed_s or 0.0:.0f} s", _homeward(best.plan), good=good)


def _known(flight: Flight, plan: Plan) -> bool:
    assert plan.certificate is not None
    kinds = {violation.kind for violation in plan.certificate.violations}
    if "items" in kinds:
        return False
    # A search for other routes knows nothing of the ways home from them.
    return kinds <= {"home"} or (
        flight.exact
        and (not flight.estimated or not (kinds <= BATTERY_KINDS or kinds == {"separation"}))
    )


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
    terms = PlanTerms(
        scenario_hash=scenario.scenario_hash(),
        seed=scenario.search.seed,
        origin=found.dem.origin,
        radio=scenario.radio,
        k_min=network.k_min,
        delta=network.delta,
        topology=network.topology,
        d_min_m=mission.d_min_m,
        length_max_m=mission.length_max_m,
        slot_count=mission.slot_count,
        horizon_s=mission.horizon_s or None,
        waypoints=found.waypoints,
        uavs=plan_uavs(scenario, found, problem.starts_m),
        wind_mps=planned_wind_mps(scenario),
        trigger=scenario.coverage.trigger,
        mission_items=scenario.fleet.mission_items,
    )
    curves = flight.trajectories(problem, routes, scenario.fleet.ids, found.dem.top_height)
    waypoints, routes = with_passed(found.waypoints, problem, routes)
    terms = replace(terms, waypoints=waypoints, fence=found.fence)
    plan = build_plan(routes, terms, flight.name, flight.parameters, curves)
    stations = ground_stations(scenario.network, found.dem)
    return rounded(replace(plan, area=found.dem.area, ground_stations=stations))


_STEADY = {"distance": "", "time": ", flown at constant speed from the first on"}


def trigger_note(plan: Plan) -> str:
    """How many photographs are not on lines where lines were asked for; empty if none."""
    if plan.trigger == "each":
        return ""
    if plan.trajectories or plan.time_parameters.get("hold_s"):
        why = "fly curves (trajectory.mode guided)"
        if not plan.trajectories:
            why = "stop at each waypoint (trajectory.hold_s)"
        return f"coverage.trigger {plan.trigger}: UAVs {why}, and take photographs one by one"
    photos = sum(waypoint.photo for waypoint in plan.waypoints)
    on_lines = sum(line.last - line.first + 1 for route in plan.routes for line in route.lines)
    if on_lines == photos:
        return ""
    return (
        f"coverage.trigger {plan.trigger}: {on_lines} of {photos} photographs lie on straight "
        f"lines of equal spacing, heading and pitch{_STEADY[plan.trigger]}; the other "
        f"{photos - on_lines} are triggered one by one"
    )


def certify_plan(
    plan: Plan, ground: GroundRule | None = None, home: GroundRule | None = None
) -> Certificate:
    """Check a plan from its positions, energy included, and height where the ground is known.

    `home` is the rule for the ways home.
    """
    floor = energy_floor_of(
        plan.radio, tuple(uav.p_max_dbm for uav in plan.uavs), plan.k_min, plan.delta
    )
    return certify(plan, energy_floor=floor, ground=ground, home_ground=home)


def read_and_certify(path: Path) -> Plan:
    """Plan of a file with a certificate made anew; raises PlanError that names the file."""
    plan = read_plan(path)
    try:
        return replace(plan, certificate=certify_plan(plan))
    except InputError as error:
        raise PlanError(f"{path}: {error}") from None


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
    passed = {waypoint.id for waypoint in plan.waypoints if not waypoint.photo} - set(index)
    unknown = {waypoint.id for waypoint in plan.waypoints} ^ set(index) ^ passed
    if unknown:
        raise PlanError(
            f"The warm start is for other waypoints: {len(unknown)} ids differ. "
            "Start from a plan for the same scenario."
        )
    return tuple(
        tuple(index[number] for number in route.waypoint_ids if number not in passed)
        for route in plan.routes
    )


def _proof(planned: Planned) -> str:
    certificate = planned.certificate
    text = f"{certificate.slot_violations} of {certificate.slot_checks} slot checks violated"
    if math.isfinite(certificate.worst_margin_db):
        text += f", margin ≥ {words.least_margin(certificate)}"
    text += ", stopped early" if planned.interrupted else ""
    return f"{planned.learned}; {text}" if planned.learned else text


def _homeward(plan: Plan) -> str:
    """Until when the fleet flies, and how far apart and high it comes home."""
    parts = (words.flight_time(plan), words.way_home(plan), words.made_for(plan))
    return "; ".join(part for part in parts if part)
