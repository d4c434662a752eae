"""The whole run: terrain to report, every stage's result in one directory."""

from __future__ import annotations

import json
from dataclasses import dataclass, replace
from pathlib import Path

from jfto.analysis.compare import compare
from jfto.analysis.comparison import Comparison
from jfto.analysis.export import comparison_csv, comparison_object, coverage_object, slots_csv
from jfto.analysis.facts import FlightFacts
from jfto.console.progress import Watcher
from jfto.pipeline.directory import (
    COVERAGE_NAME,
    FIGURES,
    INFEASIBLE_NAME,
    PLAN_NAME,
    SCENARIO_NAME,
    write_scenario,
)
from jfto.pipeline.flight import draw_flight, fly_again
from jfto.planning.routes import is_clean, plan_routes, read_and_certify
from jfto.planning.scenario_file import LoadedScenario, load_scenario
from jfto.planning.survey import load_ground, survey
from jfto.report.drawing import draw_figures
from jfto.report.reporting import write_report
from jfto_msgs_py.errors import InputError, PlanError
from jfto_msgs_py.plan import Plan
from jfto_msgs_py.plan_file import read_plan, write_plan
from jfto_msgs_py.write_file import write_file
from jfto_world.terrain import Dem


@dataclass(frozen=True)
class Run:
    """What a run came to. `plan_path` names an infeasible plan where the certificate is not clean;
    `report` and `comparison` are None where the run was interrupted after planning, `flight` where
    no flight is on record.
    """

    plan: Plan
    plan_path: Path
    comparison: Comparison | None
    report: Path | None
    interrupted: bool
    flight: FlightFacts | None = None


def run_all(loaded: LoadedScenario, directory: Path, watcher: Watcher) -> Run:
    """Every stage of the desk job; raises JftoError, leaving the results so far in `directory`."""
    run, dem = _plan(loaded, directory, watcher)
    if run.interrupted:
        return run
    return _conclude(run, loaded, directory, dem, watcher)


def plan_only(loaded: LoadedScenario, directory: Path, watcher: Watcher) -> Run:
    """Terrain to plan; raises JftoError, leaving the results so far in `directory`."""
    return _plan(loaded, directory, watcher)[0]


def take_plan(loaded: LoadedScenario, file: Path, directory: Path, watcher: Watcher) -> Run:
    """A plan that is there already, checked anew and copied to `directory`.

    Raises PlanError where it is not for the scenario's fleet and slots.
    """
    write_scenario(loaded, directory / SCENARIO_NAME)
    watcher.begin("routes", "checking with independent code")
    plan = read_and_certify(file)
    _require_fit(plan, loaded, file)
    path = save_plan(plan, directory / PLAN_NAME)
    length = f"{plan.total_length_m / 1000:.2f} km"
    watcher.end("routes", length, f"from {file}, checked anew", good=is_clean(plan))
    if plan.scenario_hash != loaded.scenario.scenario_hash():
        watcher.warn(f"{file} was planned with other values than {loaded.path} has.")
    return Run(plan, path, None, None, interrupted=False)


def _require_fit(plan: Plan, loaded: LoadedScenario, file: Path) -> None:
    scenario = loaded.scenario
    ids = tuple(uav.id for uav in plan.uavs)
    if ids != scenario.fleet.ids:
        raise PlanError(
            f"{file} is for {', '.join(ids)}, {loaded.path} for {', '.join(scenario.fleet.ids)}. "
            "Give both the same fleet."
        )
    if plan.slots.count != scenario.mission.slot_count:
        raise PlanError(
            f"{file} has {plan.slots.count} slots, mission.slot_count in {loaded.path} is "
            f"{scenario.mission.slot_count}. Make them agree."
        )


def _plan(loaded: LoadedScenario, directory: Path, watcher: Watcher) -> tuple[Run, Dem]:
    write_scenario(loaded, directory / SCENARIO_NAME)
    found = survey(loaded, watcher)
    if found.coverage is not None:
        write_file(
            directory / COVERAGE_NAME, json.dumps(coverage_object(found.coverage), indent=1) + "\n"
        )
    planned = plan_routes(loaded.scenario, found, watcher)
    path = save_plan(planned.plan, directory / PLAN_NAME)
    return Run(planned.plan, path, None, None, interrupted=planned.interrupted), found.dem


def rebuild(directory: Path, watcher: Watcher) -> Run:
    """Comparison, figures and report anew from scenario, plan and bag of a run directory."""
    if not directory.is_dir():
        raise InputError(f"{directory}: is no directory. Name the directory of a run.")
    if not (directory / SCENARIO_NAME).exists():
        raise InputError(
            f"{directory}: holds no {SCENARIO_NAME}, so it is not the directory of a run. "
            "Make one with jfto run SCENARIO."
        )
    loaded = load_scenario(directory / SCENARIO_NAME)
    path = directory / PLAN_NAME
    if not path.exists() and (directory / INFEASIBLE_NAME).exists():
        path = directory / INFEASIBLE_NAME
    plan = read_plan(path)
    dem = load_ground(loaded)
    run = Run(plan, path, None, None, interrupted=False)
    return _conclude(run, loaded, directory, dem, watcher)


def save_plan(plan: Plan, path: Path) -> Path:
    """Write a clean plan to `path`, another one beside it as .infeasible.json; returns where.

    A clean plan that already lies at `path` is never replaced by an infeasible one.
    """
    if not is_clean(plan):
        path = path.with_name(f"{path.stem}.infeasible.json")
    write_plan(plan, path)
    return path


def write_comparison(plan: Plan, comparison: Comparison, scene: str, directory: Path) -> None:
    """Write comparison.json, comparison.csv and slots.csv."""
    facts = comparison_object(plan, comparison, scene)
    write_file(directory / "comparison.json", json.dumps(facts, indent=1) + "\n")
    write_file(directory / "comparison.csv", comparison_csv([(scene, comparison)]))
    write_file(directory / "slots.csv", slots_csv(plan, comparison))


def _conclude(run: Run, loaded: LoadedScenario, directory: Path, dem: Dem, watcher: Watcher) -> Run:
    """What comes after the plan, and after the flight where one is on record."""
    evaluation, plan = loaded.scenario.evaluation, run.plan
    comparison = compare(plan, evaluation.n_dc, watcher)
    write_comparison(plan, comparison, evaluation.paper_scene, directory)
    flight = fly_again(directory, loaded, plan, comparison, dem, watcher)
    draw_figures(plan, comparison, dem, evaluation.slot_shown, directory / FIGURES, watcher)
    if flight is not None:
        draw_flight(flight, dem, directory / FIGURES)
    title = f"{len(plan.uavs)} UAVs over {len(plan.waypoints)} waypoints"
    wind_mps = loaded.scenario.trajectory.wind_mps
    report = write_report(
        directory, title, plan, comparison, dem, evaluation.paper_scene, wind_mps, watcher, flight
    )
    return replace(run, comparison=comparison, report=report, flight=flight)
