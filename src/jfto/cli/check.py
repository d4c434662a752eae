"""jfto check."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from jfto.cli.options import PATH, json_option, print_json

if TYPE_CHECKING:
    from jfto.planning.check import Checked
    from jfto_msgs_py.records.plan import Plan
    from jfto_planner.coverage import Coverage


@click.command("check")
@click.argument("plans", type=PATH, nargs=-1, required=True, metavar="PLAN…")
@click.option(
    "--scenario",
    "scenario_file",
    type=PATH,
    metavar="FILE",
    help="Whose terrain lies below. Default: scenario.yaml beside the plan.",
)
@json_option
def command(plans: tuple[Path, ...], scenario_file: Path | None, as_json: bool) -> int:
    """Verify each PLAN from its positions alone, with code that planning does not use.

    Every slot and ten instants between slots: visits, separation, neighbours, connectivity,
    durations, lengths, energy; the ways home down to the pads; and height above the ground all the
    way, where the terrain is at hand. Several are the sorties of one
    scenario: every waypoint is in one of them. Status 0 if all holds, 3 if not.
    """
    from jfto.analysis.export import coverage_object
    from jfto.cli.failure import EXIT_INFEASIBLE
    from jfto.cli.results import plan_facts
    from jfto.planning.check import check_plan
    from jfto.planning.sorties import faults_together

    checked = [check_plan(path, scenario_file) for path in plans]
    read = [one.plan for one in checked]
    faults = faults_together(read) if len(read) > 1 else ()
    if as_json:
        facts = [
            plan_facts(one.plan, str(path))
            | {"ground": one.ground, "coverage": one.coverage and coverage_object(one.coverage)}
            for one, path in zip(checked, plans, strict=True)
        ]
        print_json(facts[0] if len(facts) == 1 else {"sorties": facts, "together": list(faults)})
    else:
        for one, path in zip(checked, plans, strict=True):
            _print(one, path)
        for fault in faults:
            click.echo(f"✗ {fault}")
        if len(read) > 1 and not faults:
            count = len({waypoint.id for one in read for waypoint in one.waypoints})
            click.echo(f"✓ {len(read)} sorties, each of {count} waypoints in one of them")
    good = all(one.clean for one in read) and not faults
    return 0 if good else EXIT_INFEASIBLE


def _print(checked: Checked, path: Path) -> None:
    from jfto import words

    read = checked.plan
    certificate, sortie = read.certificate, read.sortie
    assert certificate is not None
    part = f", sortie {sortie.number} of {sortie.count}" if sortie.count > 1 else ""
    click.echo(f"{path}: {len(read.uavs)} UAVs, {read.photo_count} waypoints{part}")
    facts = {
        "neighbours": f"{certificate.slot_violations} of {certificate.slot_checks} slot checks "
        f"violated, {certificate.fine_violations} violations at 10 × finer sampling",
        "margin": words.least_margin(certificate, 2),
        "separation": words.least_distance(read, certificate.worst_separation_m),
        "length": f"{read.total_length_m / 1000:.2f} km, {read.length_max_m / 1000:g} km allowed",
        "duration": words.flight_time(read),
        "way home": words.way_home(read) or "not planned: older plan, or written by others",
        "fence": words.fence(read) or "none given",
        "ground": checked.ground,
        **({} if checked.coverage is None else _seen(checked.coverage)),
        "battery": _battery(read),
        "wind": words.made_for(read),
        "energy": _energy(certificate.energy_floor_j, [uav.energy_j for uav in read.uavs]),
    }
    for name, text in facts.items():
        click.echo(f"  {name:<11} {text}")
    for violation in certificate.violations[:20]:
        click.echo(f"  ✗ {violation.message}")
    if len(certificate.violations) > 20:
        click.echo(f"  and {len(certificate.violations) - 20} more (--json lists all)")
    click.echo("✓ verified" if certificate.clean else "✗ not feasible")


def _seen(coverage: Coverage) -> dict[str, str]:
    """What the photos show of the area, and how far they overlap."""
    from jfto import words

    proof, pairs = coverage.certificate, coverage.overlaps
    return {
        "area seen": f"{100 * proof.seen_once:.1f} % once, {100 * proof.seen_twice:.1f} % twice",
        "overlap σ_h": words.overlap(pairs.across),
        "overlap σ_v": words.overlap(pairs.along),
    }


def _battery(plan: Plan) -> str:
    """What is left of the scarcest battery, or of the shortest endurance, on landing."""
    from jfto_world.motion.battery import airborne, drain_of

    texts = []
    for a, (uav, home) in enumerate(zip(plan.uavs, plan.homes, strict=bool(plan.homes))):
        drain = drain_of(plan, a)
        if drain is not None:
            capacity_wh = drain.battery.capacity_wh
            left = 1 - drain.energy_wh(airborne(plan, a)) / capacity_wh
            text = f"{100 * left:.0f} % of {capacity_wh:g} Wh left on landing"
            spare = left - drain.battery.reserve_percent / 100
        elif uav.endurance_s:
            spare_s = uav.endurance_s - home.landed_s
            text = f"{spare_s:.0f} s of {uav.endurance_s:g} s left on landing"
            spare = spare_s / uav.endurance_s
        else:
            continue
        texts.append((spare, f"{text} ({uav.id}, the tightest)"))
    if not texts:
        return (
            "not checked: neither fleet.battery_wh nor fleet.endurance_s is given, or no way home"
        )
    return min(texts)[1]


def _energy(floor_j: tuple[float, ...], budget_j: list[float]) -> str:
    if not floor_j:
        return "not checked"
    share = max(100 * floor / budget for floor, budget in zip(floor_j, budget_j, strict=True))
    return f"topology costs {share:.0f} % of the tightest budget at least"
