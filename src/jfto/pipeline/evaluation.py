"""Comparison of the algorithms on plans and scenarios, one or several."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from jfto.analysis.comparison import Comparison, compare
from jfto.analysis.export import comparison_csv, comparison_object, slots_csv
from jfto.console.progress import SILENT, Progress
from jfto.planning.cures import would_help
from jfto.planning.routes import plan_routes, read_and_certify
from jfto.planning.scenario_file import SCENARIO_NAME, LoadedScenario, load_scenario
from jfto.planning.survey import survey
from jfto.planning.terrain import known_ground
from jfto.reporting.figures import draw, plan_drawings
from jfto_msgs_py.files import write_file, write_json
from jfto_msgs_py.records.plan import Plan
from jfto_msgs_py.scenario.mission import EvaluationPart
from jfto_world.terrain import Dem


@dataclass(frozen=True)
class Evaluated:
    """A plan, how the algorithms compare on it, and what else the figures need.

    `dem` is None for a plan whose scenario is not at hand; `cures` would help an infeasible one
    that was made here.
    """

    label: str
    plan: Plan
    comparison: Comparison
    dem: Dem | None
    evaluation: EvaluationPart
    cures: tuple[str, ...] = ()

    @property
    def scene(self) -> str:
        """Scene of the paper to compare with."""
        return self.evaluation.paper_scene


def evaluate_scenario(loaded: LoadedScenario, progress: Progress = SILENT) -> Evaluated:
    """Plan a scenario and compare; raises JftoError."""
    found = survey(loaded, progress)
    planned = plan_routes(loaded.scenario, found, progress)
    cures = would_help(planned, found.dem, progress)
    evaluation = loaded.scenario.evaluation
    comparison = compare(planned.plan, evaluation.n_dc, progress)
    return Evaluated(loaded.path.stem, planned.plan, comparison, found.dem, evaluation, cures)


def evaluate_plan_file(path: Path, progress: Progress = SILENT) -> Evaluated:
    """Check and compare a plan file, with the scenario of its run directory if there is one."""
    plan = read_and_certify(path)
    beside = path.parent / SCENARIO_NAME
    dem, evaluation = None, EvaluationPart()
    if beside.exists():
        loaded = load_scenario(beside)
        dem, evaluation = known_ground(loaded), loaded.scenario.evaluation
    comparison = compare(plan, min(evaluation.n_dc, plan.slots.count), progress)
    label = path.stem if evaluation.paper_scene == "none" else evaluation.paper_scene
    return Evaluated(label, plan, comparison, dem, evaluation)


def write_evaluation(done: list[Evaluated], directory: Path, progress: Progress = SILENT) -> None:
    """Write the table as CSV and JSON, and for each plan a folder with its slots and figures."""
    rows = [(one.label, one.comparison) for one in done]
    write_file(directory / "comparison.csv", comparison_csv(rows))
    facts = [comparison_object(one.plan, one.comparison, one.scene) for one in done]
    write_json(directory / "comparison.json", facts)
    labels = [one.label for one in done]
    for number, one in enumerate(done):
        # Several plans of one scene share its label.
        before = labels[:number].count(one.label)
        folder = directory / (f"{one.label}-{before + 1}" if before else one.label)
        write_file(folder / "slots.csv", slots_csv(one.plan, one.comparison))
        if one.dem is None:
            progress.warn(
                f"{one.label}: no {SCENARIO_NAME} beside the plan, so no terrain: maps left out."
            )
        drawings = plan_drawings(one.plan, one.comparison, one.dem, one.evaluation.slot_shown)
        draw(drawings, folder, progress)
