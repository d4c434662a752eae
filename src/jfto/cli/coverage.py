"""jfto coverage."""

from __future__ import annotations

from pathlib import Path

import click

from jfto.cli.options import (
    debug_option,
    json_option,
    load,
    out_option,
    scenario_argument,
    set_option,
)


@click.command("coverage")
@scenario_argument
@out_option("FILE", "not written; .csv or .geojson")
@set_option
@json_option
@debug_option
def command(
    scenario: Path,
    out: Path | None,
    overrides: tuple[str, ...],
    as_json: bool,
    debug: bool,  # noqa: ARG001  main() reads it
) -> int:
    """Place the cameras of SCENARIO and prove by ray casting what they see.

    \b
    Example:  jfto coverage config/demo.yaml --set coverage.gsd_cm=5 -o waypoints.csv
    """
    loaded = load(scenario, overrides)

    from jfto.analysis.export import coverage_object
    from jfto.analysis.waypoint_export import check_suffix, write_waypoints
    from jfto.console.summary import print_json
    from jfto.console.watcher import TerminalWatcher
    from jfto.planning.survey import survey

    if out is not None:
        check_suffix(out)
    with TerminalWatcher(quiet=as_json) as watcher:
        found = survey(loaded, watcher)
    if out is not None:
        write_waypoints(found, out)
    if as_json:
        facts = {"waypoints": len(found.waypoints), "terrain": found.dem.description}
        if found.coverage is not None:
            facts = {**coverage_object(found.coverage), "terrain": found.dem.description}
        print_json(facts)
        return 0
    click.echo(f"Terrain     {found.dem.description}")
    if found.coverage is not None:
        for note in found.coverage.notes:
            if note.action != "added":
                which = "" if note.waypoint_id is None else f" waypoint {note.waypoint_id}"
                click.echo(f"  {note.action}{which}: {note.reason}")
    if out is not None:
        click.echo(f"Waypoints   {out}")
    return 0
