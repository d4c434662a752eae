"""The field screen as one renderable that fits any terminal."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial

from rich.console import Console, ConsoleOptions, Group, RenderableType, RenderResult
from rich.progress_bar import ProgressBar
from rich.rule import Rule
from rich.table import Table
from rich.text import Text

from jfto.field import words
from jfto.field.selection import shown_events, shown_uavs
from jfto.field.state import FieldState, UavField

# From the first width on there is room for batteries, from the second for bars and phases; below
# the last a UAV takes two lines.
_WIDEST, _WIDE, _NARROW = 120, 108, 72
_MOST_LINKS = 4
# Lines besides those of UAVs and events: title, bar, network, table's head, rule.
_FRAME = 6
_LEAST_EVENTS = 3


class FieldView:
    """Shows a state: title, network, one row per UAV, events. Nothing of it scrolls away.

    Where the terminal is too small for all, what is well gives way to what is not, and the rest
    is counted.
    """

    def __init__(self, state: FieldState) -> None:
        self.state = state

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
        """Lay the state out for the width and height at hand."""
        width, height = options.max_width, options.height or console.size.height
        per_uav = 2 if width < _NARROW else 1
        room = max(height - _FRAME - _LEAST_EVENTS, per_uav)
        uavs, hidden = shown_uavs(self.state, room // per_uav)
        left = height - _FRAME - per_uav * len(uavs) - (1 if hidden else 0)
        events, older = shown_events(self.state.events, max(left - 1, _LEAST_EVENTS))
        parts: list[RenderableType] = [
            self._title(width),
            self._bar(width),
            _line(words.network(self.state)),
            _blocks(self.state, uavs) if per_uav == 2 else _table(self.state, uavs, width),
        ]
        if hidden:
            parts.append(words.left_out(hidden, self.state.k_min))
        parts.append(Rule("what happened", style=words.SOFT, align="left"))
        parts += [_line(words.event(one)) for one in events]
        if older:
            parts.append(Text(f"and {older} more in the log", words.SOFT))
        yield Group(*parts)

    def _title(self, width: int) -> RenderableType:
        state = self.state
        left = Text(state.title, "bold").append(f"   {state.doing}", "bold cyan")
        if width >= _NARROW:
            left.append(f"   {words.fleet(state)}", "")
        right = Text(f"{words.clock(state.clock_s)} of {words.clock(state.horizon_s)}", "bold")
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


def _table(state: FieldState, uavs: Sequence[UavField], width: int) -> Table:
    wide = width >= _WIDE
    columns: list[tuple[str, Callable[[UavField], Text]]] = [("UAV", words.name)]
    columns += [("", words.phase), ("timing", words.timing)] if wide else [("", words.status)]
    columns += [("waypoints, next", words.waypoint)]
    columns += [("energy", partial(words.energy, bar=wide))]
    if width >= _WIDEST and any(uav.battery_percent is not None for uav in uavs):
        columns += [("battery", words.battery)]
    table = Table(box=None, expand=True, pad_edge=False, header_style=words.SOFT)
    for title, _ in columns:
        table.add_column(title, no_wrap=True)
    table.add_column("linked to, dB to spare", ratio=1, no_wrap=True, overflow="ellipsis")
    for uav in uavs:
        cells = [cell(uav) for _, cell in columns]
        table.add_row(*cells, words.links(uav, state.k_min, _MOST_LINKS))
    return table


def _blocks(state: FieldState, uavs: Sequence[UavField]) -> RenderableType:
    """Two lines per UAV, for narrow terminals."""
    lines = []
    for uav in uavs:
        head = words.name(uav)
        for part in (words.status(uav), words.waypoint(uav), words.energy(uav, bar=False)):
            head.append("  ").append_text(part)
        lines += [_line(head), _line(Text("    ").append_text(_few_links(state, uav)))]
    return Group(*lines)


def _few_links(state: FieldState, uav: UavField) -> Text:
    return words.links(uav, state.k_min, 3)


def _line(text: Text) -> Text:
    text.no_wrap, text.overflow = True, "ellipsis"
    return text
