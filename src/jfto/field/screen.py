"""Shows states as they come: a screen on a terminal, lines elsewhere."""

from __future__ import annotations

import time
from collections.abc import Callable
from types import TracebackType

from rich.console import Console
from rich.live import Live

from jfto.field import words
from jfto.field.state import FieldState
from jfto.field.view import FieldView

# Off a terminal so often a line says how things stand.
LINE_EVERY_S = 10.0


class FieldScreen:
    """Use as a context manager and call `show` with each new state, from one thread.

    On a terminal the screen is taken over, and the last state stays when it is given back.
    Elsewhere events are printed as they come, and a line about the fleet every `LINE_EVERY_S` by
    `seconds`, a clock that does not jump.
    """

    def __init__(
        self, console: Console | None = None, seconds: Callable[[], float] = time.monotonic
    ) -> None:
        self.console = console or Console(stderr=True, highlight=False)
        self._seconds = seconds
        self._live = (
            Live(console=self.console, screen=True, auto_refresh=False)
            if self.console.is_terminal
            else None
        )
        self._state: FieldState | None = None
        self._told = 0
        self._line_at = float("-inf")

    def __enter__(self) -> FieldScreen:
        if self._live is not None:
            self._live.start()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if self._live is not None:
            self._live.stop()
            if self._state is not None:
                self.console.print(FieldView(self._state))
        elif self._state is not None:
            self._print_line(self._state)

    def show(self, state: FieldState) -> None:
        """Replace what is shown."""
        self._state = state
        if self._live is not None:
            self._live.update(FieldView(state), refresh=True)
            return
        for one in state.events[self._told :]:
            self.console.print(words.event(one), soft_wrap=True)
        self._told = len(state.events)
        if self._seconds() - self._line_at >= LINE_EVERY_S:
            self._print_line(state)

    def _print_line(self, state: FieldState) -> None:
        self._line_at = self._seconds()
        self.console.print(state_line(state), markup=False, soft_wrap=True)


def state_line(state: FieldState) -> str:
    """The whole state in one plain line, worst things named."""
    parts = [
        f"{words.clock(state.clock_s)} {state.doing}",
        f"slot {max(state.slot, 0)}/{state.slot_count}",
        f"{state.done}/{state.total} waypoints",
        words.fleet(state),
        words.network(state).plain,
    ]
    timed = [uav for uav in state.uavs if uav.late_s is not None]
    if timed:
        worst = max(timed, key=lambda uav: abs(uav.late_s or 0.0))
        parts.append(f"{worst.id} {words.timing(worst).plain}")
    shares = {uav.id: uav.energy_share for uav in state.uavs if uav.energy_share is not None}
    if shares:
        least = min(shares, key=lambda one: shares[one])
        parts.append(f"energy {100 * shares[least]:.0f} % ({least})")
    return " | ".join(parts)
