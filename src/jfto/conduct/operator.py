"""The operator at a terminal: lines before the flight, a typed word, a screen in flight."""

from __future__ import annotations

import select
import sys
import time
from collections.abc import Callable
from types import TracebackType

from rich.console import Console
from rich.markup import escape

from jfto.field.screen import FieldScreen
from jfto.field.state import FieldState
from jfto_msgs_py.records.event import ERROR, WARN

# What has to be typed: Enter alone must not arm anything.
WORD = "arm"
_WORD_WAIT_S = 600.0
_MARKS = {True: "[yellow]![/yellow]", False: "[green]·[/green]"}


class Terminal:
    """Use as a context manager. `count` vehicles fly; with `quiet` nothing is shown."""

    def __init__(self, console: Console, count: int, *, quiet: bool) -> None:
        self._console, self._count, self._quiet = console, count, quiet
        self._screen: FieldScreen | None = None

    def __enter__(self) -> Terminal:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if self._screen is not None:
            self._screen.__exit__(kind, error, trace)

    def tell(self, text: str, level: int) -> None:
        """A line of its own."""
        mark = "[red]✗[/red]" if level >= ERROR else _MARKS[level >= WARN]
        self._console.print(f"{mark} {escape(text)}", soft_wrap=True)

    def ask(self, idle: Callable[[], bool]) -> bool:
        """Whether the word was typed; anything else, or ten minutes of nothing, is a no."""
        self._console.print(f"Type {WORD} to arm {self._count} vehicles, anything else to stop: ")
        end_s = time.monotonic() + _WORD_WAIT_S
        while time.monotonic() < end_s and idle():
            if select.select([sys.stdin], [], [], 0.0)[0]:
                return sys.stdin.readline().strip().lower() == WORD
        return False

    def show(self, state: FieldState) -> None:
        """The screen, which is taken over with the first state."""
        if self._quiet:
            return
        if self._screen is None:
            self._screen = FieldScreen(self._console)
            self._screen.__enter__()
        self._screen.show(state)
