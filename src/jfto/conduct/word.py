"""What it takes to let vehicles arm."""

from __future__ import annotations

import sys

from jfto_msgs_py.errors import InputError


def require_word(*, simulated: bool, armed: bool) -> None:
    """Refuse a flight of real vehicles that nobody could give the word for.

    Raises InputError where neither --arm was given nor a terminal is there to type the word.
    """
    if simulated or armed or sys.stdin.isatty():
        return
    raise InputError(
        "vehicles that are not simulated arm on a typed word, and there is no terminal to type it. "
        "Give --arm, or look first with --until arm. Nothing was done."
    )
