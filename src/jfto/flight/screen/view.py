"""The screen of a flight as one renderable that fits any terminal."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial

from rich.console import Console, ConsoleOptions, Group, RenderableType, RenderResult
from rich.progress_bar import ProgressBar
from rich.rule import Rule
from rich.table import Table
from rich.text import Text

from jfto.flight.screen import texts
from jfto.flight.screen.selection import shown_events, shown_uavs
from jfto.flight.screen.state import FlightState, UavState
from jfto_msgs_py.records.event import WARN, Event

# From the first width on there is room for batteries, from the second for bars and phases; below
# the last a UAV takes two lines.
_WIDEST, _WIDE, _NARROW = 120, 108, 72
_MOST_LINKS = 4
# Lines besides those of UAVs and events: title, bar, network, table's head, rule.
_FRAME = 6
_LEAST_EVENTS = 3


class FlightView:
    """Shows a state: title, network, one row per UAV, events. Nothing of it scrolls away.

    Where the terminal is too small for all, what is well gives way to what is not, and the rest
    is counted.
    """

    def __init__(self, state: FlightState) -> None:
        self.state = state

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
        """Lay the state out for the width and height at hand."""
        width, height = options.max_width, options.height or console.size.height
        per_uav = 2 if width < _NARROW else 1
        room = max(height - _FRAME - _LEAST_EVENTS, per_uav)
        uavs, hidden = shown_uavs(self.state, room // per_uav)
        left = height - _FRAME - per_uav * len(uavs) - (1 if hidden else 0)
        events, older = self._events(console, width, max(left - 1, _LEAST_EVENTS))
        parts: list[RenderableType] = [
            self._title(width),
            self._bar(width),
            _line(texts.network(self.state)),
            _blocks(self.state, uavs) if per_uav == 2 else _table(self.state, uavs, width),
        ]
        if hidden:
            parts.append(texts.left_out(hidden, self.state.k_min))
        parts.append(Rule("what happened", style=texts.SOFT, align="left"))
        parts += events
        if older:
            parts.append(Text(f"and {older} more in the log", texts.SOFT))
        yield Group(*parts)

    def _events(self, console: Console, width: int, room: int) -> tuple[list[Text], int]:
        """Events in at most `room` lines, and how many are left out.

        Where there is room they are said in full, trouble first; the newest trouble always is.
        """
        state = self.state

        def more(one: Event) -> int:
            """Lines beyond the first that an event takes in full."""
            return len(texts.event(one, state.lift_off_ns).wrap(console, width)) - 1

        newest = next((one for one in reversed(state.events) if one.level >= WARN), None)
        kept = 0 if newest is None else min(more(newest), room - 1)
        shown, older = shown_events(state.events, room - kept)
        spare = room - len(shown)
        lines = {
            index: _line(texts.event(one, state.lift_off_ns)) for index, one in enumerate(shown)
        }
        for index in sorted(lines, key=lambda index: (shown[index].level < WARN, -index)):
            if more(shown[index]) <= spare:
                spare -= more(shown[index])
                lines[index] = texts.event(shown[index], state.lift_off_ns)
        return list(lines.values()), older

    def _title(self, width: int) -> RenderableType:
        state = self.state
        left = Text(state.title, "bold").append(f"   {state.doing}", "bold cyan")
        if width >= _NARROW:
            left.append(f"   {texts.fleet(state)}", "")
        right = Text(f"{texts.clock(state.clock_s)} of {texts.clock(state.horizon_s)}", "bold")
        grid = Table.grid(expand=True)
        grid.add_column(no_wrap=True, overflow="ellipsis", ratio=1)
        grid.add_column(justify="right", no_wrap=True)
        grid.add_row(left, right)
        return grid

    def _bar(self, width: int) -> RenderableType:
        state = self.state
        tail = Text(f"{state.done}/{state.total} waypoints")
        if state.slot >= 0 and width >= _NARROW:
            tail.append(f"   slot {min(state.slot, state.slot_count)}/{state.slot_count}")
        grid = Table.grid(expand=True, padding=(0, 1))
        grid.add_column(ratio=1)
        grid.add_column(justify="right", no_wrap=True)
        grid.add_row(
            ProgressBar(
                max(state.total, 1), state.done, complete_style="cyan", finished_style="green"
            ),
            tail,
        )
        return grid


def _table(state: FlightState, uavs: Sequence[UavState], width: int) -> Table:
    wide = width >= _WIDE
    columns: list[tuple[str, Callable[[UavState], Text]]] = [("UAV", texts.name)]
    columns += [("", texts.phase), ("timing", texts.timing)] if wide else [("", texts.status)]
    columns += [("waypoints, next", texts.waypoint)]
    columns += [("energy", partial(texts.energy, bar=wide))]
    if width >= _WIDEST and any(uav.battery_percent is not None for uav in uavs):
        columns += [("battery", texts.battery)]
    table = Table(box=None, expand=True, pad_edge=False, header_style=texts.SOFT)
    for title, _ in columns:
        table.add_column(title, no_wrap=True)
    table.add_column("linked to, dB to spare", ratio=1, no_wrap=True, overflow="ellipsis")
    for uav in uavs:
        cells = [cell(uav) for _, cell in columns]
        table.add_row(*cells, texts.links(uav, state.k_min, _MOST_LINKS))
    return table


def _blocks(state: FlightState, uavs: Sequence[UavState]) -> RenderableType:
    """Two lines per UAV, for narrow terminals."""
    lines = []
    for uav in uavs:
        head = texts.name(uav)
        for part in (texts.status(uav), texts.waypoint(uav), texts.energy(uav, bar=False)):
            head.append("  ").append_text(part)
        lines += [_line(head), _line(Text("    ").append_text(_few_links(state, uav)))]
    return Group(*lines)


def _few_links(state: FlightState, uav: UavState) -> Text:
    return texts.links(uav, state.k_min, 3)


def _line(text: Text) -> Text:
    text.no_wrap, text.overflow = True, "ellipsis"
    return text
