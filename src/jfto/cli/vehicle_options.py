"""Who flies, on every command line in the same words."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import click

Function = Callable[..., Any]
PATH = click.Path(path_type=Path)
_FORMS = (
    "sim or sim:N: simulated ones. LINK: vehicles with system ids 1, 2 …, all on one link or each "
    "on its own (udpin:, udpout:, tcp:, serial:). UAV=SYSID@LINK[#UID] per vehicle. {}May be "
    "repeated or separated by commas."
)
_FROM_SCENARIO = "roster: those of the scenario's section mavlink_bridge. "

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


def vehicles_option(*, scenario: bool = True, **settings: Any) -> Callable[[Function], Function]:
    """Option --vehicles; with `scenario` that may name them too. `settings` are click's."""
    text = _FORMS.format(_FROM_SCENARIO if scenario else "")
    return click.option("--vehicles", metavar="WHO", multiple=True, help=text, **settings)


def roster_texts(vehicles: tuple[str, ...]) -> list[str]:
    """Roster entries of a command line, one by one."""
    return [text for entry in vehicles for text in entry.split(",") if text]
