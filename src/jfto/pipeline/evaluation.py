"""Comparison of the algorithms on plans and scenarios, one or several."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path

from jfto.analysis.compare import compare
from jfto.analysis.comparison import Comparison
from jfto.analysis.export import comparison_csv, comparison_object, slots_csv
from jfto.console.progress import Watcher
from jfto.pipeline.directory import SCENARIO_NAME
from jfto.planning.routes import plan_routes, read_and_certify
from jfto.planning.scenario_file import LoadedScenario, load_scenario
from jfto.planning.survey import load_ground, survey
from jfto.report.drawing import draw_figures
from jfto_msgs_py.plan import Plan
from jfto_msgs_py.scenario.mission import EvaluationPart
from jfto_msgs_py.write_file import write_file
from jfto_world.terrain import Dem


@dataclass(frozen=True)
class Evaluated:
    """A plan, how the algorithms compare on it, and what else the figures need.

    `dem` is None for a plan whose scenario is not at hand.
    """

    label: str
    plan: Plan
    comparison: Comparison
    dem: Dem | None
    evaluation: EvaluationPart

    @property
    def scene(self) -> str:
        """Scene of the paper to compare with."""
        return self.evaluation.paper_scene


def evaluate_scenario(loaded: LoadedScenario, watcher: Watcher) -> Evaluated:
    """Plan a scenario and compare; raises JftoError."""
    found = survey(loaded, watcher)
    planned = plan_routes(loaded.scenario, found, watcher)
    evaluation = loaded.scenario.evaluation
    comparison = compare(planned.plan, evaluation.n_dc, watcher)
    return Evaluated(loaded.path.stem, planned.plan, comparison, found.dem, evaluation)


def evaluate_plan_file(path: Path, watcher: Watcher) -> Evaluated:
    """Check and compare a plan file, with the scenario of its run directory if there is one."""
    plan = read_and_certify(path)
    beside = path.parent / SCENARIO_NAME
    dem, evaluation = None, EvaluationPart()
    if beside.exists():
        loaded = load_scenario(beside)
        dem, evaluation = load_ground(loaded), loaded.scenario.evaluation
    comparison = compare(plan, min(evaluation.n_dc, plan.slots.count), watcher)
    label = path.stem if evaluation.paper_scene == "none" else evaluation.paper_scene
    return Evaluated(label, plan, comparison, dem, evaluation)


def write_evaluation(done: list[Evaluated], directory: Path, watcher: Watcher) -> None:
    """Write the table as CSV and JSON, and for each plan its slots and figures."""
    rows = [(one.label, one.comparison) for one in done]
    write_file(directory / "comparison.csv", comparison_csv(rows))
    facts = [comparison_object(one.plan, one.comparison, one.scene) for one in done]
    write_file(directory / "comparison.json", json.dumps(facts, indent=1) + "\n")
    for one in done:
        folder = directory / one.label
        write_file(folder / "slots.csv", slots_csv(one.plan, one.comparison))
        if one.dem is None:
            watcher.warn(
                f"{one.label}: no {SCENARIO_NAME} beside the plan, so no terrain: maps left out."
            )
        draw_figures(one.plan, one.comparison, one.dem, one.evaluation.slot_shown, folder, watcher)
