"""Tables and lines that commands print as their result."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
from rich.console import Console
from rich.table import Table

from jfto.analysis.comparison import Comparison
from jfto.analysis.export import certificate_object, comparison_object
from jfto.analysis.paper import (
    GROUND_HEADINGS,
    HEADINGS,
    active_text,
    beside_paper,
    ground_cells,
    ratios_text,
)
from jfto.cli.failure import EXIT_INTERRUPTED, EXIT_OTHER
from jfto.cli.options import print_json
from jfto.console.progress import Progress
from jfto.pipeline.directory import FLIGHT_NAME, flight_bags
from jfto.pipeline.run import Run
from jfto.planning.scenario_file import LoadedScenario
from jfto_msgs_py.records.plan import Plan

if TYPE_CHECKING:
    from jfto.flight.job import FlightEnd, FlightJob

_SHOWN_VIOLATIONS = 8


def plan_facts(plan: Plan, path: str, cures: tuple[str, ...] = ()) -> dict[str, Any]:
    """What a program wants to know of a plan; `cures` would help where it is infeasible."""
    assert plan.certificate is not None
    return {
        "plan": path,
        "scenario_hash": plan.scenario_hash,
        "seed": plan.seed,
        "sortie": {"number": plan.sortie.number, "count": plan.sortie.count},
        "uavs": len(plan.uavs),
        "waypoints": plan.photo_count,
        "length_m": plan.total_length_m,
        "horizon_s": plan.slots.horizon_s,
        "landed_s": plan.landed_s,
        "wind_mps": plan.wind_mps,
        "certificate": certificate_object(plan.certificate),
        "cures": list(cures),
    }


def print_infeasible(plan: Plan, path: str, cures: tuple[str, ...] = ()) -> None:
    """Say on standard error what is violated, what would help, and where the plan lies."""
    certificate = plan.certificate
    assert certificate is not None
    violations = certificate.violations
    first = violations[0].message if violations else "the certificate is not clean."
    click.echo(f"Infeasible: {first}", err=True)
    for violation in violations[1:_SHOWN_VIOLATIONS]:
        click.echo(f"  also: {violation.message}", err=True)
    if len(violations) > _SHOWN_VIOLATIONS:
        click.echo(f"  and {len(violations) - _SHOWN_VIOLATIONS} more violations", err=True)
    if cures:
        click.echo(f"  would help: {' · or '.join(cures)}", err=True)
    click.echo(
        f"Closest plan kept: {path} ({certificate.slot_violations} of {certificate.slot_checks} "
        "slot checks violated, listed inside)",
        err=True,
    )


def comparison_table(rows: list[tuple[str, Comparison]]) -> Table:
    """Ours beside the paper's for any number of scenes."""
    table = Table(title="Ours, and in brackets the paper's figures", title_justify="left")
    table.add_column("Scene")
    table.add_column("Algorithm", no_wrap=True)
    grounded = any(comparison.ours.ground for _, comparison in rows)
    for heading in (*HEADINGS, "Listed", "Heard", *(GROUND_HEADINGS if grounded else ())):
        table.add_column(heading, justify="right")
    for scene, comparison in rows:
        for index, result in enumerate(comparison.results):
            cells = [
                f"{mine} ({theirs})" if theirs else mine
                for mine, theirs in beside_paper(result, scene)
            ]
            ours = result is comparison.ours
            table.add_row(
                scene if index == 0 else "",
                f"[bold]{result.name}[/bold]" if ours else result.name,
                *cells,
                *result.spans,
                *ground_cells(result),
                end_section=ours,
            )
    return table


def print_comparison(rows: list[tuple[str, Comparison]]) -> None:
    """The table and C-TOP's throughput ratios on standard output."""
    console = Console(highlight=False)
    if not console.is_terminal:
        console.width = 124
    console.soft_wrap = True
    console.print(comparison_table(rows))
    for scene, comparison in rows:
        ratios = ratios_text(comparison, scene)
        if not ratios:
            console.print(f"{scene}: no algorithm has any link to compare", markup=False)
            continue
        console.print(
            f"{scene}: the throughput of {comparison.ours.name} is {ratios}", markup=False
        )
        console.print(f"{scene}: {active_text(comparison)}", markup=False)
        for note in comparison.notes:
            console.print(f"{scene}: {note}", markup=False)


def say_flight(plan: Plan, job: FlightJob, end: FlightEnd, progress: Progress) -> None:
    """How the flight went and what was recorded of it."""
    from jfto.flight.outcome import Ending

    parts = ["all landed" if end.outcome.ending == Ending.LANDED else end.outcome.text]
    if end.speedup is not None and job.simulated:
        parts.append(f"×{end.speedup:.1f} of {job.settings.speedup:g} asked")
    if end.deaths:
        parts.append(f"{len(end.deaths)} processes died")
    good = end.outcome.good
    progress.end("flight", f"{len(plan.uavs)} vehicles", ", ".join(parts), good=good)
    for path in flight_bags(job.directory):
        _say_bag(path, progress)


def _say_bag(path: Path, progress: Progress) -> None:
    from jfto.bag.contents import BagError
    from jfto.bag.reader import Bag

    size = sum(file.stat().st_size for file in path.rglob("*") if file.is_file())
    try:
        topics = len(Bag(path).facts.topics)
    except BagError as error:
        progress.end("record", str(path), str(error), good=False)
        return
    progress.end("record", f"{size / 1e6:.1f} MB", f"{topics} topics in {path}")


def print_run(loaded: LoadedScenario, run: Run, end: FlightEnd | None, *, as_json: bool) -> None:
    """The comparison at the desk, what is infeasible, and where the report lies.

    After a dry run, which makes neither, where the plan lies.
    """
    scene, compared = loaded.scenario.evaluation.paper_scene, run.comparison
    if as_json:
        facts = plan_facts(run.plan, str(run.plan_path), run.cures)
        facts["comparison"] = compared and comparison_object(run.plan, compared, scene)
        facts["flight"] = None if end is None else _flight_facts(run, end)
        facts["report"] = run.report and str(run.report)
        print_json(facts)
        return
    if compared is None:
        click.echo(f"Plan        {run.plan_path}")
        return
    print_comparison([("this scene" if scene == "none" else scene, compared)])
    if not run.plan.clean:
        print_infeasible(run.plan, str(run.plan_path), run.cures)
    click.echo(f"Report      {run.report}")


def next_sortie(scenario: Path, directory: Path, plan: Plan) -> str:
    """Which sortie that was, and how to fly the next one."""
    sortie = plan.sortie
    said = f"Sortie      {sortie.number} of {sortie.count}"
    if sortie.number < sortie.count:
        said += f"; next: jfto run {scenario} -o {directory} --sortie {sortie.number + 1}"
    return said


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
