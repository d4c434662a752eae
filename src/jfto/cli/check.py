"""jfto check."""

from __future__ import annotations

from pathlib import Path

import click

from jfto.cli.options import PATH, json_option, print_json


@click.command("check")
@click.argument("plan", type=PATH)
@json_option
def command(plan: Path, as_json: bool) -> int:
    """Verify PLAN from its positions alone, with code that planning does not use.

    Every slot and ten instants between slots: visits, separation, neighbours, connectivity,
    durations, lengths, energy. Status 0 if all holds, 3 if not.
    """
    from jfto.cli.failure import EXIT_INFEASIBLE
    from jfto.cli.results import plan_facts
    from jfto.planning.routes import read_and_certify

    read = read_and_certify(plan)
    certificate = read.certificate
    assert certificate is not None
    if as_json:
        print_json(plan_facts(read, str(plan)))
        return 0 if certificate.clean else EXIT_INFEASIBLE
    longest = max(route.end_s for route in read.routes)
    click.echo(f"{plan}: {len(read.uavs)} UAVs, {len(read.waypoints)} waypoints")
    facts = {
        "neighbours": f"{certificate.slot_violations} of {certificate.slot_checks} slot checks "
        f"violated, {certificate.fine_violations} violations at 10 × finer sampling",
        "margin": f"{certificate.worst_margin_db:.2f} dB at least "
        f"({certificate.worst_margin_uav}, slot {certificate.worst_margin_slot:g})",
        "separation": f"{certificate.worst_separation_m:.1f} m at least, {read.d_min_m:g} m asked",
        "length": f"{read.total_length_m / 1000:.2f} km, {read.length_max_m / 1000:g} km allowed",
        "duration": f"{longest:.0f} s",
        "energy": _energy(certificate.energy_floor_j, [uav.energy_j for uav in read.uavs]),
    }
    for name, text in facts.items():
        click.echo(f"  {name:<11} {text}")
    for violation in certificate.violations[:20]:
        click.echo(f"  ✗ {violation.message}")
    if len(certificate.violations) > 20:
        click.echo(f"  and {len(certificate.violations) - 20} more (--json lists all)")
    click.echo("✓ verified" if certificate.clean else "✗ not feasible")
    return 0 if certificate.clean else EXIT_INFEASIBLE


def _energy(floor_j: tuple[float, ...], budget_j: list[float]) -> str:
    if not floor_j:
        return "not checked"
    share = max(100 * floor / budget for floor, budget in zip(floor_j, budget_j, strict=True))
    return f"topology costs {share:.0f} % of the tightest budget at least"
