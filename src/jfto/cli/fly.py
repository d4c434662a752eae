"""jfto fly."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from jfto.cli.mission_options import (
    PATH,
    build,
    build_options,
    key_option,
    roster_texts,
    speedup_option,
    vehicles_option,
)
from jfto.cli.options import debug_option

if TYPE_CHECKING:
    from jfto.fleet_session import FleetSession
    from jfto_mavlink.flight.follow import FlightRecord


@click.command("fly")
@click.argument("plan", type=PATH)
@vehicles_option
@key_option
@speedup_option
@click.option("-o", "--out", type=PATH, metavar="DIR", help="Logs. Default: flight-<UTC time>.")
@click.option(
    "--stagger", type=click.FloatRange(0.0), default=0.0, metavar="S", help="Time between starts."
)
@click.option(
    "--gate",
    "gates",
    type=click.IntRange(1),
    multiple=True,
    metavar="K",
    help="All wait behind their K-th waypoint for its planned time, so that the fleet keeps its "
    "slots by the clock. May be repeated.",
)
@click.option(
    "--lead",
    type=click.FloatRange(10.0),
    default=150.0,
    show_default=True,
    metavar="S",
    help="With --gate: time for upload and checks before the planned start.",
)
@click.option("--yes", is_flag=True, help="Start real vehicles without asking.")
@build_options
@debug_option
def command(
    plan: Path,
    out: Path | None,
    stagger: float,
    gates: tuple[int, ...],
    lead: float,
    yes: bool,
    debug: bool,  # noqa: ARG001  main() reads it
    **choices: Any,
) -> int:
    """Fly PLAN from the pads to the landing: upload, verify, check, arm, start, follow.

    Every vehicle must hold its verified mission and pass its checks, or none is armed. Writes a
    .tlog per vehicle and flight.json. Status 0 if every waypoint was passed within --within.

    \b
    Example:  jfto fly plan.json --vehicles sim:3 --speedup 10
    """
    from jfto.cli.failure import EXIT_INTERRUPTED
    from jfto.cli.flight_screen import FlightScreen
    from jfto.fleet_session import open_fleet
    from jfto.flight_log import flight_object, new_flight_directory
    from jfto.simulated_fleet import grounds
    from jfto_mavlink.fleet.fly import Fleet, FlySettings, deliver_to_fleet, fly_fleet
    from jfto_mavlink.fleet.monitor import watch_fleet
    from jfto_mavlink.flight.preflight import GateSettings
    from jfto_world.motion.arducopter.takeoff import SPOOL_UP_S

    built = build(plan, choices, tuple(k - 1 for k in gates), 0.0 if gates else None)
    missions = built.missions
    directory = new_flight_directory(out)
    pads = {uav: mission.home_deg_m for uav, mission in missions.items()}
    with FlightScreen() as screen, open_fleet(
        roster_texts(choices["vehicles"]),
        pads,
        speedup=choices["speedup"],
        log_directory=directory,
        key_file=choices["key_file"],
        on_event=screen.event,
        grounds=grounds(built.plan, built.dem),
    ) as session:  # fmt: skip
        start_at_s = None
        if gates:
            start_at_s = session.clock() + lead
            indices = tuple(k - 1 for k in gates)
            missions = build(plan, choices, indices, session.unix() + lead).missions
        sent = {uav: mission.mission for uav, mission in missions.items()}
        release = deliver_to_fleet(session.runner, sent, screen.report).release()
        if not session.simulated and not yes:
            click.confirm(f"Start {len(missions)} vehicles?", abort=True)
        slot_s = built.plan.slots.duration_s
        checks = GateSettings(utc_error_max_s=slot_s / 4 if gates else None)
        # Times count from lift-off, to which the rotors take their time from the start on.
        begin_s = None if start_at_s is None else start_at_s - SPOOL_UP_S
        settings = FlySettings(stagger, begin_s, checks)
        try:
            fleet = Fleet(session.runner, missions, screen.report)
            watch_fleet(fleet, screen.event)
            records = fly_fleet(fleet, release, settings)
        except KeyboardInterrupt:
            _say_interrupted(session)
            return EXIT_INTERRUPTED
    flight = flight_object(records, screen.events)
    (directory / "flight.json").write_text(json.dumps(flight, indent=1) + "\n", encoding="utf-8")
    return _show(records, choices["within"], directory)


def _say_interrupted(session: FleetSession) -> None:
    """Nobody follows the vehicles any more: say what each of them does, and how to stop it."""
    click.echo("Interrupted. Nothing was sent to the vehicles:", err=True)
    for uav in session.runner.roster.uavs:
        vehicle = session.runner.vehicle(uav)
        state = "armed" if vehicle.armed else "disarmed"
        click.echo(f"  {uav}  {state}, {vehicle.mode_name}", err=True)
    if not session.simulated:
        click.echo("Call them home: jfto mission order return --vehicles …", err=True)


def _show(records: dict[str, FlightRecord], within_m: float, directory: Path) -> int:
    """One line per vehicle; the status is 1 if a waypoint was missed."""
    status = 0
    for uav, record in records.items():
        missed = record.missed(within_m)
        worst_m = max((p.closest_m for p in record.passages), default=0.0)
        late = [p.late_s for p in record.passages if p.late_s is not None]
        worst_s = max(late, key=abs, default=0.0)
        mark = "✗" if missed or record.ended != "landed" else "✓"
        click.echo(
            f"{mark} {uav:<8} {len(record.passages) - len(missed)} of {len(record.passages)} "
            f"waypoints within {within_m:g} m, worst {worst_m:.1f} m, {worst_s:+.1f} s, "
            f"{record.ended} after {record.duration_s:.0f} s"
        )
        if missed:
            click.echo(f"    missed: {', '.join(map(str, missed))}")
        status |= int(mark == "✗")
    click.echo(f"Logs   {directory}")
    return status
