"""Tables and lines that commands print as their result."""

from __future__ import annotations

import json
import math
from typing import Any

import click
from rich.console import Console
from rich.table import Table

from jfto.analysis.comparison import OURS, AlgorithmResult, Comparison
from jfto.analysis.export import active_text, certificate_object, paper_ratios, throughput_ratios
from jfto.analysis.paper import PAPER, PaperRow
from jfto.planning.cures import cures
from jfto_msgs_py.plan import Plan

_SHOWN_VIOLATIONS = 8


def print_json(facts: dict[str, Any]) -> None:
    """One JSON object on standard output."""
    click.echo(json.dumps(facts, indent=1))


def plan_facts(plan: Plan, path: str) -> dict[str, Any]:
    """What a program wants to know of a plan."""
    assert plan.certificate is not None
    return {
        "plan": path,
        "scenario_hash": plan.scenario_hash,
        "seed": plan.seed,
        "uavs": len(plan.uavs),
        "waypoints": len(plan.waypoints),
        "length_m": plan.total_length_m,
        "horizon_s": plan.slots.horizon_s,
        "certificate": certificate_object(plan.certificate),
        "cures": list(cures(plan)),
    }


def print_infeasible(plan: Plan, path: str) -> None:
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
    click.echo(f"  would help: {' · or '.join(cures(plan))}", err=True)
    click.echo(
        f"Closest plan kept: {path} ({certificate.slot_violations} of {certificate.slot_checks} "
        "slot checks violated, listed inside)",
        err=True,
    )


def comparison_table(rows: list[tuple[str, Comparison]]) -> Table:
    """Ours beside the paper's for any number of scenes."""
    table = Table(title="Ours, and in brackets the paper's figures", title_justify="left")
    table.add_column("Scene")
    table.add_column("Algorithm")
    for heading in ("Traverses all", "ξ (%)", "Throughput (Mb/s)", "Hops", "Neighbours"):
        table.add_column(heading, justify="right")
    for scene, comparison in rows:
        theirs = PAPER.get(scene, {})
        for index, result in enumerate(comparison.results):
            cells = _cells(result, theirs.get(result.name))
            name = f"[bold]{result.name}[/bold]" if result.name == OURS else result.name
            table.add_row(
                scene if index == 0 else "", name, *cells, end_section=result.name == OURS
            )
    return table


def print_comparison(rows: list[tuple[str, Comparison]]) -> None:
    """The table and C-TOP's throughput ratios on standard output."""
    console = Console(highlight=False)
    if not console.is_terminal:
        console.width = 110
    console.soft_wrap = True
    console.print(comparison_table(rows))
    for scene, comparison in rows:
        theirs = paper_ratios(scene)
        parts = [
            f"{ratio:.2f} × {name}" + (f" (paper {theirs[name]:.2f})" if name in theirs else "")
            for name, ratio in throughput_ratios(comparison).items()
        ]
        console.print(f"{scene}: C-TOP's throughput is {', '.join(parts)}")
        console.print(f"{scene}: {active_text(comparison)}", markup=False)
        for note in comparison.notes:
            console.print(f"{scene}: {note}", markup=False)


def _cells(result: AlgorithmResult, paper: PaperRow | None) -> list[str]:
    ours = [
        _yes(result.traverses_all),
        f"{100 * result.linked.connectivity_rate:.1f}",
        f"{result.linked.mean_throughput_mbps:.0f}",
        _number(result.linked.hops),
    ]
    if paper is not None:
        theirs = [
            _yes(paper.traverses_all),
            f"{100 * paper.connectivity_rate:.1f}",
            f"{paper.throughput:.0f}",
            "–" if paper.hops is None else _number(paper.hops),
        ]
        ours = [f"{mine} ({other})" for mine, other in zip(ours, theirs, strict=True)]
    return [*ours, f"{result.degree.min()}–{result.degree.max()}"]


def _yes(flag: bool) -> str:
    return "yes" if flag else "no"


def _number(value: float) -> str:
    return f"{value:.2f}" if math.isfinite(value) else "inf"
