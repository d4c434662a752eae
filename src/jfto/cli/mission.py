"""jfto mission: missions as files, and on vehicles."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from jfto.cli.mission_files import FORMAT_KEYS, export_files
from jfto.cli.mission_link import link_fleet, link_for
from jfto.cli.mission_options import build_all, build_options, uav_option
from jfto.cli.options import (
    PATH,
    key_option,
    speedup_option,
    vehicles_option,
)
from jfto.cli.quick_order import order_bridge
from jfto_msgs_py.errors import InputError
from jfto_msgs_py.mission_file.write_wpml import DRONES
from jfto_msgs_py.order_socket import VERBS

if TYPE_CHECKING:
    from jfto_mavlink.protocol.item import Mission

_vehicles_option = vehicles_option(required=True)


@click.group("mission")
def command() -> None:
    """Missions for ArduPilot: as files for other ground stations, and on vehicles.

    PLAN is a plan of `jfto plan`. Everything sent to a vehicle is read back and compared.
    """


@command.command("export")
@click.argument("plan", type=PATH)
@click.option("-o", "--out", type=PATH, metavar="DIR", default=Path("missions"), show_default=True)
@click.option("--format", "form", type=click.Choice(FORMAT_KEYS), default="plan", show_default=True)
@click.option(
    "--drone", type=click.Choice(list(DRONES)), help="wpml: the type that DJI's waylines are for."
)
@build_options
def export(plan: Path, out: Path, form: str, drone: str | None, **choices: Any) -> int:
    """Write PLAN for other programs: one file per UAV, or one for all of kml, kmz, csv, geojson.

    plan: QGroundControl. waypoints: Mission Planner. wpml: DJI Pilot 2. litchi: Litchi. What each
    holds and what it loses: docs/how-to/files.md.
    """
    return export_files(plan, out, form, drone, choices)


@command.command("import")
@click.argument("source", type=PATH)
@click.argument("target", type=PATH, required=False)
def import_(source: Path, target: Path | None) -> int:
    """Read a .plan or .waypoints file, check it, and write it to TARGET in its format."""
    from jfto_mavlink.files import read_mission, write_mission
    from jfto_mavlink.mission.limits import MissionLimits, check_limits
    from jfto_mavlink.mission.stored import mission_hash

    mission = read_mission(source)
    check_limits(str(source), mission.items, MissionLimits())
    click.echo(
        f"{source}: {len(mission.items)} items, {len(mission.fence)} fence, "
        f"{len(mission.rally)} rally points   {mission_hash(mission)[:12]}"
    )
    for note in mission.notes:
        click.echo(f"  {note}")
    if target is not None:
        for path in write_mission(target, mission):
            click.echo(f"{path} written")
        if mission.parameters and target.suffix.lower() != ".plan":
            names = ", ".join(name for name, _ in mission.parameters)
            click.echo(f"  {target}: has no place for the autopilot's settings {names}")
    return 0


@command.command("diff")
@click.argument("old", type=PATH)
@click.argument("new", type=PATH)
def diff(old: Path, new: Path) -> int:
    """What changes from mission file OLD to NEW, as the autopilot would store it.

    Status 0 if both fly the same, 1 if not.
    """
    from jfto_mavlink.files import read_mission
    from jfto_mavlink.mission.stored import diff_missions

    lines = diff_missions(read_mission(old), read_mission(new))
    for line in lines:
        click.echo(line)
    click.echo("the same" if not lines else f"{len(lines)} lines differ")
    return 1 if lines else 0


@command.command("upload")
@click.argument("files", type=PATH, nargs=-1, required=True, metavar="PLAN|FILE...")
@uav_option
@_vehicles_option
@key_option
@speedup_option
@build_options
def upload(files: tuple[Path, ...], names: tuple[str, ...], **choices: Any) -> int:
    """Upload PLAN's missions to all vehicles, read back, compare; all are released or none.

    Each FILE is a mission of another ground station (.plan or .waypoints) for one vehicle, with its
    fence and rally points. It is held to the same limits, to its own fence and, with --scenario, to
    the terrain.

    Parameters that they rely on are set, and what they were is kept beside PLAN: put them back
    after the flight with jfto mission restore.

    \b
    Example:  jfto mission upload plan.json --vehicles udpin:0.0.0.0:14550
              jfto mission upload edited.plan --uav uav2 --vehicles uav2=2@udpin:0.0.0.0:14550
    """
    from jfto.console.vehicles import show_vehicles
    from jfto.supervision.graph_table import PARAMETERS_NAME
    from jfto_mavlink.fleet.fly import Fleet, deliver_to_fleet, set_parameters
    from jfto_mavlink.mission.changed import ChangedParameters

    missions = build_all(files, names, choices)
    changed = ChangedParameters(files[0].with_name(PARAMETERS_NAME))
    with link_for(files, missions, choices) as link, show_vehicles() as progress:
        sent = {uav: mission.mission for uav, mission in missions.items()}
        outcome = deliver_to_fleet(link, sent, progress.report)
        if not outcome.failed:
            set_parameters(Fleet(link, missions, progress.report, changed))
    for uav, delivered in outcome.delivered.items():
        click.echo(f"✓ {uav}  verified  {delivered.duration_s:5.1f} s  {delivered.digest[:12]}")
    for uav, error in outcome.failed.items():
        click.echo(f"✗ {uav}  {error}", err=True)
    outcome.release()
    click.echo(f"✓ fleet released: {len(outcome.delivered)} vehicles hold their missions")
    if changed.vehicles:
        click.echo(f"Parameters as they were: {changed.path}, for jfto mission restore")
    return 0


@command.command("restore")
@click.argument("record", type=PATH)
@_vehicles_option
@key_option
def restore(record: Path, **choices: Any) -> int:
    """Put back the parameters that RECORD says vehicles had before a flight.

    RECORD is parameters.json of a run, or the one beside the plan of jfto mission upload. It is
    gone once all is put back. Vehicles in flight are left alone.
    """
    from jfto.console.vehicles import show_vehicles
    from jfto_mavlink.errors import RosterError
    from jfto_mavlink.mission.changed import ChangedParameters, restore_parameters

    changed = ChangedParameters(record)
    if not changed.vehicles:
        click.echo(f"{record}: nothing is left to put back.")
        return 0
    with link_fleet(choices, uavs=tuple(changed.vehicles)) as link, show_vehicles() as progress:
        unknown = set(changed.vehicles) - set(link.roster.uavs)
        if unknown:
            raise RosterError(205, f"{', '.join(sorted(unknown))}: not in the roster.")
        jobs = dict.fromkeys(changed.vehicles, lambda context: restore_parameters(context, changed))
        results = link.run(jobs, progress.report)
    failed = {uav: one for uav, one in results.items() if isinstance(one, Exception)}
    return _show_differences(failed or dict.fromkeys(results, ()))


@command.command("verify")
@click.argument("files", type=PATH, nargs=-1, required=True, metavar="PLAN|FILE...")
@uav_option
@_vehicles_option
@key_option
@build_options
def verify_command(files: tuple[Path, ...], names: tuple[str, ...], **choices: Any) -> int:
    """Compare what vehicles hold with PLAN's missions or FILE, item by item; 1 if different."""
    from jfto.console.vehicles import show_vehicles
    from jfto_mavlink.mission.changed import compare_parameters
    from jfto_mavlink.mission.deliver import verify
    from jfto_mavlink.protocol.exchange import Context, Exchange

    missions = build_all(files, names, choices)

    def compare(context: Context, mission: Mission) -> Exchange[tuple[str, ...]]:
        items = yield from verify(context, mission)
        parameters = yield from compare_parameters(context, mission.parameters)
        return (*items, *parameters)

    def job(mission: Mission) -> Any:
        return lambda context: compare(context, mission)

    with link_for(files, missions, choices) as link, show_vehicles() as progress:
        jobs = {uav: job(mission.mission) for uav, mission in missions.items()}
        results = link.run(jobs, progress.report)
    return _show_differences(results)


@command.command("clear")
@_vehicles_option
@key_option
@click.option("--yes", is_flag=True, help="Do not ask.")
def clear_command(yes: bool, **choices: Any) -> int:
    """Remove mission, fence and rally points from vehicles."""
    from jfto.console.vehicles import show_vehicles
    from jfto_mavlink.mission.deliver import clear
    from jfto_mavlink.protocol.exchange import Context, Exchange
    from jfto_mavlink.protocol.item import FENCE, MISSION, RALLY

    if not yes:
        click.confirm("Clear the missions of all these vehicles?", abort=True)

    def job(context: Context) -> Exchange[tuple[str, ...]]:
        for mission_type in (MISSION, FENCE, RALLY):
            yield from clear(context, mission_type)
        return ()

    with link_fleet(choices) as link, show_vehicles() as progress:
        results = link.run(dict.fromkeys(link.roster.uavs, job), progress.report)
    return _show_differences(results)


@command.command("sign")
@_vehicles_option
@click.option("--key", "key_file", type=PATH, metavar="FILE", required=True)
@click.option("--create", is_flag=True, help="Make the key file first.")
def sign(key_file: Path, create: bool, **choices: Any) -> int:
    """Give vehicles the signing key in FILE, over a cable: the key travels in the clear."""
    from jfto.console.vehicles import show_vehicles
    from jfto_mavlink.io.signing import create_key, load_signer
    from jfto_mavlink.protocol.exchange import Context, Exchange
    from jfto_mavlink.protocol.setup import setup_signing

    if create:
        create_key(key_file)
        click.echo(f"{key_file} written, mode 0600")
    signer = load_signer(key_file)

    def job(context: Context) -> Exchange[tuple[str, ...]]:
        yield from setup_signing(context, signer)
        return ()

    with link_fleet(choices | {"key_file": None}) as link, show_vehicles() as progress:
        results = link.run(dict.fromkeys(link.roster.uavs, job), progress.report)
    return _show_differences(results)


@command.command("order")
@click.argument("order", type=click.Choice(list(VERBS)))
@vehicles_option()
@key_option
@click.option("--only", metavar="UAV", multiple=True, help="These vehicles; all if left out.")
def order_command(order: str, only: tuple[str, ...], **choices: Any) -> int:
    """Tell flying vehicles to pause, resume, hold, return home or land, and see them do it.

    The bridge that runs on this computer, on the ROS domain of ROS_DOMAIN_ID, tells all of them at
    once. With --vehicles they are linked by this command itself, which takes seconds; vehicles that
    are not heard do not keep the others from being told.

    \b
    Example:  jfto mission order home
              jfto mission order land --vehicles udpin:0.0.0.0:14550 --only uav2
    """
    if not choices["vehicles"]:
        if only or choices["key_file"] is not None:
            raise InputError("--only and --key are for links of one's own: give --vehicles.")
        return order_bridge(order)
    from jfto.console.vehicles import show_vehicles
    from jfto_mavlink.errors import RosterError
    from jfto_mavlink.flight import control
    from jfto_mavlink.protocol.exchange import Context, Exchange

    orders = {
        "pause": control.pause,
        "resume": control.resume,
        "hold": control.brake,
        "home": control.return_home,
        "return": control.return_home,
        "land": control.land,
    }

    def job(context: Context) -> Exchange[tuple[str, ...]]:
        yield from orders[order](context)
        return ()

    with link_fleet(choices, complete=False) as link, show_vehicles() as progress:
        uavs = link.roster.uavs
        unknown = set(only) - set(uavs)
        if unknown:
            raise RosterError(205, f"{', '.join(sorted(unknown))}: not in the roster.")
        results = link.run(dict.fromkeys(only or uavs, job), progress.report)
    return _show_differences(results)


def _show_differences(results: dict[str, Any]) -> int:
    """One line per vehicle; the status is 1 if any differs or failed."""
    status = 0
    for uav, result in results.items():
        if isinstance(result, Exception):
            click.echo(f"✗ {uav}  {result}", err=True)
            status = 1
        elif result:
            click.echo(f"✗ {uav}  {len(result)} differences")
            for text in result:
                click.echo(f"    {text}")
            status = 1
        else:
            click.echo(f"✓ {uav}")
    return status
