"""Arguments and options that several commands share."""

from __future__ import annotations

import json
from collections.abc import Callable
from functools import wraps
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from jfto_msgs_py.scenario.mission import METHODS

if TYPE_CHECKING:
    from jfto.planning.scenario_file import LoadedScenario

Function = Callable[..., Any]

# Existence and kind of files are checked where they are read, with better words.
PATH = click.Path(path_type=Path)

_FORMS = (
    "sim or sim:N: simulated ones. LINK: vehicles with system ids 1, 2 …, all on one link or each "
    "on its own (udpin:, udpout:, tcp:, serial:). UAV=SYSID@LINK[#UID] per vehicle. roster: "
    "those of the scenario's section mavlink_bridge. May be repeated or separated by commas."
)

scenario_argument = click.argument("scenario", type=PATH)
set_option = click.option(
    "--set",
    "overrides",
    metavar="KEY=VALUE",
    multiple=True,
    help="Override a scenario key, or a node's as mavlink_bridge.style; may be repeated. "
    "docs/reference/scenario.md and topics.md list them.",
)
# Of commands that take a plan.
flown_under_option = click.option(
    "--scenario",
    type=PATH,
    metavar="FILE",
    help="What it is flown under. Default: scenario.yaml beside the plan; without one, what the "
    "plan itself says, over unknown terrain.",
)
seed_option = click.option(
    "--seed", type=click.IntRange(0), metavar="N", help="Seed of the search; search.seed if absent."
)
method_option = click.option(
    "--method",
    type=click.Choice(METHODS),
    help="How routes are found; search.method if absent. A learned result is shown beside what the "
    "search alone finds with the same effort.",
)
json_option = click.option("--json", "as_json", is_flag=True, help="Print JSON for programs.")
key_option = click.option(
    "--key", "key_file", type=PATH, metavar="FILE", help="MAVLink signing key, mode 0600."
)
speedup_option = click.option(
    "--speedup",
    type=click.FloatRange(0.1, 50.0),
    default=1.0,
    show_default=True,
    help="Simulated vehicles only: how much faster than the clock.",
)


def print_json(facts: dict[str, Any]) -> None:
    """One JSON object on standard output."""
    click.echo(json.dumps(facts, indent=1))


def out_option(kind: str, default: str) -> Callable[[Function], Function]:
    """Option -o/--out that names where results go."""
    return click.option("-o", "--out", type=PATH, metavar=kind, help=f"Default: {default}.")


def scenario_options(
    *, searched: bool = True, required: bool = True
) -> Callable[[Function], Function]:
    """Argument SCENARIO and what changes it; the command takes the loaded scenario as `loaded`.

    With `searched` the seed and the method of the search are among that. Where it is not
    `required`, `loaded` is None without it.
    """

    def decorate(function: Function) -> Function:
        @wraps(function)
        def command(
            scenario: Path | None,
            overrides: tuple[str, ...],
            seed: int | None = None,
            method: str | None = None,
            **others: Any,
        ) -> int:
            loaded = None if scenario is None else load(scenario, overrides, seed, method)
            return function(loaded=loaded, **others)

        argument = click.argument("scenario", type=PATH, required=required)
        changing = (method_option, seed_option, set_option) if searched else (set_option,)
        for option in reversed((argument, *changing)):
            command = option(command)
        return command

    return decorate


def load(
    scenario: Path,
    overrides: tuple[str, ...],
    seed: int | None = None,
    method: str | None = None,
) -> LoadedScenario:
    """The scenario of a command line."""
    from jfto.planning.scenario_file import load_scenario

    seeding = () if seed is None else (f"search.seed={seed}",)
    choosing = () if method is None else (f"search.method={method}",)
    return load_scenario(scenario, (*overrides, *seeding, *choosing))


def vehicles_option(**settings: Any) -> Callable[[Function], Function]:
    """Option --vehicles; `settings` are click's."""
    return click.option("--vehicles", metavar="WHO", multiple=True, help=_FORMS, **settings)


def roster_texts(vehicles: tuple[str, ...]) -> list[str]:
    """Roster entries of a command line, one by one."""
    return [text for entry in vehicles for text in entry.split(",") if text]
