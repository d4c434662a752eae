"""jfto report."""

from __future__ import annotations

from pathlib import Path

import click

from jfto.cli.options import PATH, json_option, print_json


@click.command("report")
@click.argument("directory", metavar="DIR", type=PATH)
@json_option
def command(directory: Path, as_json: bool) -> int:
    """Rebuild comparison, figures and report of the run in DIR from its scenario, plan and bag.

    With a bag the flight is held against the plan: waypoints, timing, the certificate on the flown
    tracks, network and energy as planned and as flown. Its facts go to DIR/flight.json, which
    docs/reference/flight.md describes.
    """
    from jfto.analysis.flight_file import flight_facts_object
    from jfto.console.stages import show_stages
    from jfto.pipeline.run import rebuild

    with show_stages(quiet=as_json) as progress:
        outcome = rebuild(directory, progress)
    if as_json:
        facts = {"plan": str(outcome.plan_path), "report": str(outcome.report)}
        flight = outcome.flight
        print_json(facts | {"flight": None if flight is None else flight_facts_object(flight)})
    else:
        click.echo(f"Report      {outcome.report}")
    return 0
