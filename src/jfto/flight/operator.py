"""The operator: lines before the flight, a typed word that arms, a screen in flight."""

from __future__ import annotations

import select
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from jfto.console.console import BAD, NOTE, WARNING, Console
from jfto.console.preflight import show_page
from jfto.flight.screen.screen import FlightScreen
from jfto.flight.screen.state import FlightState
from jfto_mavlink.preflight.page import Preflight
from jfto_msgs_py.errors import InputError
from jfto_msgs_py.records.event import ERROR, WARN

# What has to be typed: Enter alone must not arm anything.
CONFIRMATION = "arm"
_CONFIRMATION_WAIT_S = 600.0


class ConsoleOperator:
    """The operator at a console; `count` vehicles fly."""

    def __init__(self, console: Console, count: int) -> None:
        self._console, self._count = console, count
        self.screen = FlightScreen(console)

    def tell(self, text: str, level: int) -> None:
        """A line of its own; as an event it is not shown again."""
        self._console.line(text, BAD if level >= ERROR else WARNING if level >= WARN else NOTE)
        self.screen.told(text)

    def ask(self, idle: Callable[[], bool]) -> bool:
        """Whether the word was typed; anything else, or ten minutes of nothing, is a no."""
        what = f"{self._count} vehicles, anything else to stop: "
        self._console.line(f"Type {CONFIRMATION} to arm {what}")
        end_s = time.monotonic() + _CONFIRMATION_WAIT_S
        while time.monotonic() < end_s and idle():
            if select.select([sys.stdin], [], [], 0.0)[0]:
                return sys.stdin.readline().strip().lower() == CONFIRMATION
        return False

    def page(self, page: Preflight) -> None:
        """What the checks before arming came to."""
        show_page(self._console, page)

    def show(self, state: FlightState) -> None:
        """How everything stands."""
        self.screen.show(state)


@contextmanager
def operator_at(console: Console, count: int) -> Iterator[ConsoleOperator]:
    """The operator for one flight; the last state stays on the console."""
    operator = ConsoleOperator(console, count)
    try:
        yield operator
    finally:
        operator.screen.close()


def require_confirmation(*, simulated: bool, armed: bool) -> None:
    """Refuse a flight of real vehicles that nobody could give the word for.

    Raises InputError where neither --arm was given nor a terminal is there to type the word.
    """
    if simulated or armed or sys.stdin.isatty():
        return
    raise InputError(
        "vehicles that are not simulated arm on a typed word, and there is no terminal to type it. "
        "Give --arm, or look first with --until arm. Nothing was done."
    )
