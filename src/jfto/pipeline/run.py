"""The whole job of one scenario in one directory: terrain to report, each stage once.

Stages hand their records on; files are for the user, and for the next run in the same directory,
which keeps what still fits.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

from jfto.console.progress import SILENT, Progress
from jfto.pipeline.directory import (
    COVERAGE_NAME,
    FIGURES,
    FLIGHT_NAME,
    INFEASIBLE_NAME,
    PLAN_NAME,
    REPORT_NAME,
    flight_bags,
    write_scenario,
)
from jfto.pipeline.products import Products, digest
from jfto.pipeline.sorties import save_sorties, stale_sorties
from jfto.planning.scenario_file import (
    SCENARIO_NAME,
    LoadedScenario,
    load_scenario,
)
from jfto.planning.terrain import known_ground, terrain_files
from jfto.supervision.graph_table import PREFLIGHT_NAME
from jfto_mavlink.preflight.page import read_page
from jfto_msgs_py.errors import InputError, JftoError, PlanError
from jfto_msgs_py.files import read_text, write_file, write_json
from jfto_msgs_py.plan_file import read_plan, write_plan
from jfto_msgs_py.records.plan import Plan

if TYPE_CHECKING:
    from jfto.analysis.comparison import Comparison
    from jfto.analysis.facts import FlightFacts
    from jfto_world.terrain import Dem

_SIZE_LIMIT = 50_000_000
_KEPT = "kept: made of the same scenario, terrain and program"


@dataclass(frozen=True)
class Run:
    """What a run came to. `plan_path` names an infeasible plan where the certificate is not clean;
    `report` and `comparison` are None where the run ended after planning, `flight` where no flight
    is on record. `cures` would help an infeasible plan that was made in this run. `sorties` are the
    plan files of all sorties where there are several, `plan` then being the first.
    """

    plan: Plan
    plan_path: Path
    interrupted: bool = False
    comparison: Comparison | None = None
    report: Path | None = None
    flight: FlightFacts | None = None
    cures: tuple[str, ...] = ()
    sorties: tuple[Path, ...] = ()


def rebuild(directory: Path, progress: Progress = SILENT) -> Run:
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
    pipeline = Pipeline(loaded, directory, progress, anew=True)
    return pipeline.report(Run(read_plan(path), path))


def save_plan(plan: Plan, path: Path) -> Path:
    """Write a clean plan to `path`, another one beside it as .infeasible.json; returns where.

    A clean plan that already lies at `path` is never replaced by an infeasible one.
    """
    if not plan.clean:
        path = path.with_name(f"{path.stem}.infeasible.json")
    write_plan(plan, path)
    return path


def save_plans(plans: tuple[Plan, ...], path: Path) -> tuple[Path, ...]:
    """Write one plan as `save_plan` does, or the plans of several sorties beside `path`."""
    if len(plans) > 1:
        return save_sorties(plans, path)
    if plans[0].clean:
        for file in stale_sorties(path, plans):
            file.unlink()
    return (save_plan(plans[0], path),)


class Pipeline:
    """One run of a scenario in `directory`, where the resolved scenario is written at once.

    Call `plan` or `take`, fly if you will, then `report`; all raise JftoError, leaving the results
    so far. With `anew` nothing is kept of what earlier runs left there.
    """

    def __init__(
        self,
        loaded: LoadedScenario,
        directory: Path,
        progress: Progress = SILENT,
        *,
        anew: bool = False,
    ) -> None:
        self._loaded, self._directory, self._progress = loaded, directory, progress
        self._products = Products(directory, anew=anew)
        # The resolved scenario is there whatever comes.
        path = directory / SCENARIO_NAME
        written = path == loaded.path
        self._configuration = _text(path, "scenario") if written else write_scenario(loaded, path)

    def plan(self) -> Run:
        """Terrain to plan."""
        scenario = self._loaded.scenario
        inputs = digest([scenario.scenario_hash(), str(scenario.search.seed), *self._given])
        kept = self._kept_plan(inputs)
        if kept is not None:
            return kept
        from jfto.planning.cures import would_help
        from jfto.planning.sorties import plan_sorties
        from jfto.planning.survey import survey

        found = survey(self._loaded, self._progress)
        # Of an earlier scenario there may be one whose waypoints were computed.
        (self._directory / COVERAGE_NAME).unlink(missing_ok=True)
        files = []
        if found.coverage is not None:
            from jfto.analysis.export import coverage_object

            files.append(
                write_json(self._directory / COVERAGE_NAME, coverage_object(found.coverage))
            )
        self._dem = found.dem
        planned = plan_sorties(scenario, found, self._progress)
        first = planned.sorties[0]
        cures = would_help(first, found.dem, self._progress)
        paths = save_plans(planned.plans, self._directory / PLAN_NAME)
        if not planned.interrupted:
            self._products.made("plan", inputs, [*files, *paths])
        several = paths if len(paths) > 1 else ()
        return Run(
            first.plan, paths[0], interrupted=planned.interrupted, cures=cures, sorties=several
        )

    def take(self, file: Path) -> Run:
        """A plan that is there already, checked anew and copied to the directory.

        Raises PlanError where it is not for the scenario's fleet and slots.
        """
        inputs = digest(["taken", self._loaded.scenario.scenario_hash(), file])
        kept = self._kept_plan(inputs)
        if kept is not None:
            return kept
        from jfto.planning.routes import read_and_certify

        self._progress.begin("routes", "checking with independent code")
        plan = read_and_certify(file)
        _require_fit(plan, self._loaded, file)
        path = save_plan(plan, self._directory / PLAN_NAME)
        length = f"{plan.total_length_m / 1000:.2f} km"
        self._progress.end("routes", length, f"from {file}, checked anew", good=plan.clean)
        own = self._loaded.path == file
        if not own and plan.scenario_hash != self._loaded.scenario.scenario_hash():
            self._progress.warn(
                f"{file} was planned with other values than {self._loaded.path} has."
            )
        self._products.made("plan", inputs, [path])
        return Run(plan, path)

    def keep(self, plan: Plan) -> Run:
        """A certified plan that was made elsewhere, written to the directory."""
        return Run(plan, save_plan(plan, self._directory / PLAN_NAME))

    def report(self, run: Run) -> Run:
        """What comes after the plan, and after the flight where one is on record."""
        inputs = digest([self._configuration, *self._given, run.plan_path])
        comparison = self._compared(run.plan)
        flight = self._flown(run.plan, comparison)
        self._draw(run.plan, comparison, flight, inputs)
        run = replace(run, comparison=comparison, flight=flight)
        return replace(run, report=self._page(run, inputs))

    def _kept_plan(self, inputs: str) -> Run | None:
        """The plan of an earlier run, where it was made of the same."""
        files = self._products.kept("plan", inputs)
        if not files:
            return None
        paths = tuple(file for file in files if file.name != COVERAGE_NAME)
        plan = read_plan(paths[0])
        self._progress.end("routes", f"{plan.total_length_m / 1000:.2f} km", _KEPT, good=plan.clean)
        return Run(plan, paths[0], sorties=paths if len(paths) > 1 else ())

    def _compared(self, plan: Plan) -> Comparison:
        """The comparison, in memory and in files. It takes no time, so it is not kept."""
        from jfto.analysis.comparison import compare
        from jfto.analysis.export import comparison_csv, comparison_object, slots_csv

        evaluation = self._loaded.scenario.evaluation
        comparison, scene = compare(plan, evaluation.n_dc, self._progress), evaluation.paper_scene
        write_json(self._directory / "comparison.json", comparison_object(plan, comparison, scene))
        write_file(self._directory / "comparison.csv", comparison_csv([(scene, comparison)]))
        write_file(self._directory / "slots.csv", slots_csv(plan, comparison))
        return comparison

    def _flown(self, plan: Plan, comparison: Comparison) -> FlightFacts | None:
        """Facts of the flight on record, which are also written to flight.json.

        None without a bag, and where the bag holds no flight, as after a dry run; that is told.
        """
        bags = flight_bags(self._directory)
        if not bags:
            return None
        from jfto.analysis.facts import flight_facts
        from jfto.analysis.flight_file import flight_facts_object

        self._progress.begin("as flown", "reading the bag, holding it against the plan")
        scenario = self._loaded.scenario
        try:
            facts = flight_facts(bags, plan, comparison, self._dem, scenario)
        except JftoError as error:
            self._progress.end("as flown", "nothing", str(error), good=False)
            return None
        write_json(self._directory / FLIGHT_NAME, flight_facts_object(facts))
        self._progress.end(
            "as flown", f"{facts.visited}/{len(facts.passages)} waypoints", facts.in_words(),
            good=facts.good,
        )  # fmt: skip
        return facts

    def _draw(
        self,
        plan: Plan,
        comparison: Comparison,
        flight: FlightFacts | None,
        inputs: str,
    ) -> None:
        """The plan's figures, where they are not kept, and those of the flight."""
        kept = self._products.kept("figures", inputs)
        if kept:
            self._progress.end("figures", f"{len(kept) // 2} figures", _KEPT)
            if flight is None:
                return
        from jfto.reporting.figures import draw, flight_drawings, plan_drawings

        slot = self._loaded.scenario.evaluation.slot_shown
        of_plan = {} if kept else plan_drawings(plan, comparison, self._dem, slot)
        of_flight = {} if flight is None else flight_drawings(flight, self._dem)
        folder = self._directory / FIGURES
        files = draw({**of_plan, **of_flight}, folder, self._progress)
        if of_plan:
            self._products.made("figures", inputs, files[: 2 * len(of_plan)])

    def _page(self, run: Run, inputs: str) -> Path:
        path = self._directory / REPORT_NAME
        page = self._directory / PREFLIGHT_NAME
        preflight = read_page(page) if page.exists() else None
        looked = run.flight is not None or preflight is not None
        if not looked and self._products.kept("report", inputs):
            self._progress.end("report", f"{path.stat().st_size / 1e6:.1f} MB", _KEPT)
            return path
        from jfto.reporting.page import ReportContent, report_page

        assert run.comparison is not None
        self._progress.begin("report", "writing")
        scenario = self._loaded.scenario
        figures = sorted((self._directory / FIGURES).glob("*.png"))
        content = ReportContent(
            plan=run.plan,
            comparison=run.comparison,
            dem=self._dem,
            scene=scenario.evaluation.paper_scene,
            wind_mps=scenario.trajectory.wind_mps,
            figures={figure.stem: figure.read_bytes() for figure in figures},
            coverage=self._coverage(),
            configuration=self._configuration,
            flight=run.flight,
            preflight=preflight,
        )
        write_file(path, report_page(content))
        if not looked:
            self._products.made("report", inputs, [path])
        self._progress.end(
            "report", f"{path.stat().st_size / 1e6:.1f} MB", "one file, works offline"
        )
        return path

    @cached_property
    def _given(self) -> list[Path]:
        """Files that the scenario names."""
        scenario, given = self._loaded.scenario, terrain_files(self._loaded)
        named = (scenario.waypoints.file, scenario.area.file, scenario.fence.file)
        return [*given, *(self._loaded.resolve(name) for name in named if name)]

    @cached_property
    def _dem(self) -> Dem | None:
        return known_ground(self._loaded)

    def _coverage(self) -> Mapping[str, Any] | None:
        """Coverage figures of the run; None where its waypoints were not computed."""
        path = self._directory / COVERAGE_NAME
        if not path.exists():
            return None
        try:
            found = json.loads(_text(path, "coverage"))
        except json.JSONDecodeError as error:
            raise InputError(
                f"{path}: is not valid JSON: {error.msg}. Delete it, or run the scenario again."
            ) from None
        assert isinstance(found, dict)
        return found


def _text(path: Path, what: str) -> str:
    return read_text(path, InputError, what, _SIZE_LIMIT)


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
