"""Shows states as they come: a screen on a terminal, lines elsewhere."""

from __future__ import annotations

import time
from collections.abc import Callable

from rich.console import RenderableType

from jfto.console.console import Console
from jfto.flight.screen import texts
from jfto.flight.screen.state import FlightState
from jfto.flight.screen.view import FlightView

# Off a terminal so often a line says how things stand.
LINE_EVERY_S = 10.0


class FlightScreen:
    """Call `show` with each new state, and `close` in the end, from one thread.

    On a terminal the screen is taken over, and the last state stays when it is given back.
    Elsewhere events are printed as they come, and a line about the fleet every `LINE_EVERY_S` by
    `seconds`, a clock that does not jump.
    """

    def __init__(self, console: Console, seconds: Callable[[], float] = time.monotonic) -> None:
        self._console, self._seconds = console, seconds
        self._state: FlightState | None = None
        self._shown = 0
        self._said: set[str] = set()
        self._line_at = float("-inf")

    def told(self, text: str) -> None:
        """A line that has been printed already: the event that says the same is not."""
        self._said.add(" ".join(text.split()))

    def show(self, state: FlightState) -> None:
        """Replace what is shown."""
        self._state = state
        if self._console.is_terminal:
            self._console.show(FlightView(state), screen=True)
            return
        for one in state.events[self._shown :]:
            if one.text not in self._said:
                self._print(texts.event(one, state.lift_off_ns))
        self._shown = len(state.events)
        if self._seconds() - self._line_at >= LINE_EVERY_S:
            self._print_line(state)

    def close(self) -> None:
        """Give the terminal back."""
        self._console.hide()
        if self._state is None:
            return
        if self._console.is_terminal:
            self._print(FlightView(self._state))
        else:
            self._print_line(self._state)

    def _print_line(self, state: FlightState) -> None:
        self._line_at = self._seconds()
        self._console.line(state_line(state))

    def _print(self, what: RenderableType) -> None:
        self._console.rich.print(what, soft_wrap=not self._console.is_terminal)


def state_line(state: FlightState) -> str:
    """The whole state in one plain line, worst things named."""
    parts = [
        f"{texts.clock(state.clock_s)} {state.doing}",
        f"slot {max(state.slot, 0)}/{state.slot_count}",
        f"{state.done}/{state.total} waypoints",
        texts.fleet(state),
        texts.network(state).plain,
    ]
    timed = [uav for uav in state.uavs if uav.late_s is not None]
    if timed:
        worst = max(timed, key=lambda uav: abs(uav.late_s or 0.0))
        parts.append(f"{worst.id} {texts.timing(worst).plain}")
    shares = {uav.id: uav.energy_share for uav in state.uavs if uav.energy_share is not None}
    if shares:
        least = min(shares, key=lambda one: shares[one])
        parts.append(f"energy {100 * shares[least]:.0f} % ({least})")
    return " | ".join(parts)
