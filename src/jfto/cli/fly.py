"""jfto fly."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from jfto.cli.options import PATH, flown_under_option, set_option
from jfto.cli.run import flight_options, run


@click.command("fly")
@click.argument("plan", type=PATH)
@flown_under_option
@set_option
@flight_options
def command(plan: Path, scenario: Path | None, overrides: tuple[str, ...], **choices: Any) -> int:
    """Fly PLAN, adapt to how it is really flown, record it and report: jfto run --plan PLAN.

    The plan is checked anew, its missions are uploaded and read back, every vehicle must pass its
    checks or none is armed. Vehicles are simulated unless --vehicles names others: those are armed
    on --arm or on a typed word only. Plan, bag, vehicle logs and report go to one directory.

    How missions are built from the plan (style, pass_within_m, return_height_m …) is said in the
    scenario's section mavlink_bridge. Ctrl-C and exit statuses are those of jfto run.

    \b
    Example:  jfto fly plan.json
              jfto fly today/plan.json --until arm --vehicles udpin:0.0.0.0:14550
    """
    from jfto.planning.scenario_of_plan import load_scenario_for

    return run(load_scenario_for(plan, scenario, overrides), plan, choices)
