"""What `jfto run` says in the end: one line for the flight, one for the record, the report."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from jfto.analysis.export import comparison_object
from jfto.bag.errors import BagError
from jfto.bag.reader import Bag
from jfto.cli.failure import EXIT_INTERRUPTED, EXIT_OTHER
from jfto.conduct.flight_job import FlightEnd, FlightJob
from jfto.conduct.outcome import Ending
from jfto.console.summary import plan_facts, print_comparison, print_infeasible, print_json
from jfto.console.watcher import TerminalWatcher
from jfto.pipeline.flight import FLIGHT_NAME, flight_bags
from jfto.pipeline.run import Run
from jfto.planning.routes import is_clean
from jfto.planning.scenario_file import LoadedScenario
from jfto_msgs_py.plan import Plan


def say_flight(plan: Plan, job: FlightJob, end: FlightEnd, watcher: TerminalWatcher) -> None:
    """How the flight went and what was recorded of it."""
    parts = ["all landed" if end.outcome.ending == Ending.LANDED else end.outcome.text]
    if end.speedup is not None and job.simulated:
        parts.append(f"{end.speedup:.1f} × real time ({job.settings.speedup:g} asked)")
    if end.deaths:
        parts.append(f"{len(end.deaths)} processes died")
    good = end.outcome.good
    watcher.end("flight", f"{len(plan.uavs)} vehicles", ", ".join(parts), good=good)
    for path in flight_bags(job.directory):
        _say_bag(path, watcher)


def _say_bag(path: Path, watcher: TerminalWatcher) -> None:
    size = sum(file.stat().st_size for file in path.rglob("*") if file.is_file())
    try:
        topics = len(Bag(path).facts.topics)
    except BagError as error:
        watcher.end("record", str(path), str(error), good=False)
        return
    watcher.end("record", f"{size / 1e6:.1f} MB", f"{topics} topics in {path}")


def print_run(loaded: LoadedScenario, run: Run, end: FlightEnd | None, *, as_json: bool) -> None:
    """The comparison at the desk, what is infeasible, and where the report lies."""
    assert run.comparison is not None
    scene = loaded.scenario.evaluation.paper_scene
    if as_json:
        facts = plan_facts(run.plan, str(run.plan_path))
        facts["comparison"] = comparison_object(run.plan, run.comparison, scene)
        facts["flight"] = None if end is None else _flight_facts(run, end)
        facts["report"] = str(run.report)
        print_json(facts)
        return
    print_comparison([("this scene" if scene == "none" else scene, run.comparison)])
    if not is_clean(run.plan):
        print_infeasible(run.plan, str(run.plan_path))
    click.echo(f"Report      {run.report}")


def _flight_facts(run: Run, end: FlightEnd) -> dict[str, Any]:
    facts = run.flight
    return {
        "ended": end.outcome.ending.value,
        "text": end.outcome.text,
        "started": end.outcome.flown,
        "interrupted": end.outcome.interrupted,
        "good": end.outcome.good and (facts is None or facts.good),
        "speedup": None if end.speedup is None else round(end.speedup, 2),
        "processes_died": [{"name": each.name, "how": each.how} for each in end.deaths],
        "facts": None if facts is None else str(run.plan_path.parent / FLIGHT_NAME),
    }


def run_status(run: Run, end: FlightEnd | None) -> int:
    """Exit status of a feasible run."""
    if end is None:
        return 0
    if end.outcome.interrupted:
        return EXIT_INTERRUPTED
    flown_well = run.flight is None or run.flight.good
    return 0 if end.outcome.good and flown_well else EXIT_OTHER
