"""jfto coverage."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from jfto.cli.options import json_option, out_option, print_json, scenario_options

if TYPE_CHECKING:
    from jfto.planning.scenario_file import LoadedScenario


@click.command("coverage")
@scenario_options(searched=False)
@out_option("FILE", "not written; .csv, .geojson, .kml or .kmz")
@json_option
def command(loaded: LoadedScenario, out: Path | None, as_json: bool) -> int:
    """Place the cameras of SCENARIO, or read them, and prove by ray casting what they see.

    \b
    Example:  jfto coverage config/demo.yaml --set coverage.gsd_cm=5 -o waypoints.csv
    """
    from jfto import words
    from jfto.analysis.export import coverage_object
    from jfto.analysis.geo_plan import format_of, write_waypoints
    from jfto.console.stages import show_stages
    from jfto.planning.survey import judged, survey

    if out is not None:
        format_of(out)
    with show_stages(quiet=as_json) as progress:
        found = judged(survey(loaded, progress), loaded.scenario, progress)
    assert found.coverage is not None
    if out is not None:
        write_waypoints(found, out)
    if as_json:
        facts = coverage_object(found.coverage)
        facts |= {"terrain": found.dem.description, "terrain_notes": list(found.dem.notes)}
        facts["not_used"] = list(found.notes)
        print_json(facts)
        return 0
    click.echo(f"Terrain     {found.dem.description}")
    if loaded.scenario.waypoints.source not in ("coverage", "file"):
        click.echo(f"Seen        {100 * found.coverage.certificate.seen_once:.1f} % of the area")
    if found.coverage.heading_deg is not None:
        surface_m2 = found.coverage.certificate.surface_m2
        click.echo(
            f"Area        {surface_m2 / 1e4:.1f} ha of surface, rows head "
            f"{found.coverage.heading_deg:.0f}°"
        )
    for name, pairs in (
        ("σ_h", found.coverage.overlaps.across),
        ("σ_v", found.coverage.overlaps.along),
    ):
        click.echo(f"Overlap {name} {words.overlap(pairs)}")
    for note in found.coverage.notes:
        if note.action != "added":
            which = "" if note.waypoint_id is None else f" waypoint {note.waypoint_id}"
            click.echo(f"  {note.action}{which}: {note.reason}")
    if out is not None:
        click.echo(f"Waypoints   {out}")
    return 0
