"""The field screen: what an operator reads off it, on any terminal."""

from __future__ import annotations

import io
from dataclasses import replace

import pytest
from rich.console import Console

from jfto.field.screen import LINE_EVERY_S, FieldScreen, state_line
from jfto.field.selection import shown_events
from jfto.field.state import (
    ERROR,
    FLYING,
    INFO,
    SILENT,
    WARNING,
    FieldEvent,
    FieldState,
    LinkField,
    UavField,
)
from jfto.field.view import FieldView


def _uav(index: int, **changes: object) -> UavField:
    links = (LinkField(f"uav{index + 2}", 4.1), LinkField(f"uav{index + 3}", 9.3))
    plain = UavField(f"uav{index + 1}", index, FLYING, 3, 17, 8.0, 0.2, 90.0, 180.0, links=links)
    return replace(plain, **changes)  # type: ignore[arg-type]


def _state(count: int = 3, events: tuple[FieldEvent, ...] = (), **changes: UavField) -> FieldState:
    uavs = tuple(changes.get(f"uav{index + 1}", _uav(index)) for index in range(count))
    return FieldState("demo", "flying", 452.0, 730.0, 45, 150, 2, 1, uavs, events)


def _drawn(state: FieldState, width: int = 100, height: int = 24) -> list[str]:
    console = Console(file=io.StringIO(), width=width, height=height, force_terminal=True)
    with console.capture() as capture:
        console.print(FieldView(state))
    from rich.text import Text

    return Text.from_ansi(capture.get()).plain.rstrip("\n").split("\n")


def _row(lines: list[str], name: str) -> str:
    return next(line for line in lines if line[1:].startswith(f" {name} "))


def test_time_is_said_in_words_not_only_in_colour() -> None:
    """Late, early and on time are words; more than a second counts."""
    lines = _drawn(_state(uav1=_uav(0, late_s=2.4), uav2=_uav(1, late_s=-1.7)))
    assert "2.4 s late" in _row(lines, "uav1")
    assert "1.7 s early" in _row(lines, "uav2")
    assert "on time" in _row(lines, "uav3")
    assert "07:32 of 12:10" in lines[0]


def test_links_are_marked_where_little_is_to_spare() -> None:
    """Below 1 dB a link has a mark, a broken one a cross, and a UAV short of K_min says so."""
    links = (LinkField("uav9", -0.6), LinkField("uav8", 0.4), LinkField("uav7", 7.0))
    alone = (LinkField("uav7", 3.0),)
    lines = _drawn(_state(uav1=_uav(0, links=links), uav2=_uav(1, links=alone)))
    assert "uav9 -0.6✗  uav8 0.4!  uav7 7.0" in _row(lines, "uav1")
    assert "✗ 1 of 2" in _row(lines, "uav2")
    assert any("weakest uav1–uav9 -0.6✗ dB" in line for line in lines)


def test_energy_and_silence_have_words() -> None:
    """Low and empty energy, and how long a UAV has been silent."""
    lines = _drawn(
        _state(
            uav1=_uav(0, energy_left_j=30.0),
            uav2=_uav(1, energy_left_j=-1.0),
            uav3=_uav(2, phase=SILENT, age_s=4.0),
        )
    )
    assert "17 % low" in _row(lines, "uav1")
    assert "empty" in _row(lines, "uav2")
    assert "✗ silent 4 s" in _row(lines, "uav3")


@pytest.mark.parametrize(("width", "height"), [(140, 40), (100, 24), (80, 24), (60, 24), (40, 20)])
def test_the_screen_fits_its_terminal(width: int, height: int) -> None:
    """No line is longer than the terminal is wide, and no more lines come than it has."""
    events = tuple(
        FieldEvent(float(k), WARNING, "uav1", f"kind{k}", "something long happened " * 8)
        for k in range(30)
    )
    lines = _drawn(_state(20, events), width, height)
    assert max(len(line) for line in lines) <= width
    assert len(lines) <= height


def test_uavs_in_trouble_are_shown_first_where_room_is_short() -> None:
    """Of twenty UAVs the one that is silent is shown, and the rest is counted."""
    lines = _drawn(_state(20, uav18=_uav(17, phase=SILENT, age_s=9.0)), 100, 16)
    assert "✗ silent 9 s" in _row(lines, "uav18")
    assert any("more, all well" in line for line in lines)


def test_warnings_stay_when_newer_notes_come() -> None:
    """The last warning of each kind and UAV outlives notes; the newest event is there too."""
    dead = FieldEvent(1.0, ERROR, "uav4", "radio", "radio dead")
    late = FieldEvent(2.0, WARNING, "uav2", "late", "late")
    notes = [FieldEvent(3.0 + k, INFO, "uav1", "link", f"note {k}") for k in range(50)]
    kept, older = shown_events([dead, late, late, *notes], 4)
    assert [one.text for one in kept] == ["radio dead", "late", "note 48", "note 49"]
    assert older == 49


def test_off_a_terminal_events_come_once_and_a_line_now_and_then() -> None:
    """Each event is one line, at once; how things stand is a line every ten seconds."""
    out = io.StringIO()
    now = [0.0]
    first = FieldEvent(1.0, WARNING, "uav2", "late", "runs 2.4 s late: slots shifted")
    second = FieldEvent(2.0, INFO, "uav3", "landed", "down")
    with FieldScreen(Console(file=out, width=200), lambda: now[0]) as screen:
        screen.show(_state(events=(first,)))
        now[0] = LINE_EVERY_S / 2
        screen.show(_state(events=(first, second)))
        now[0] = LINE_EVERY_S
        screen.show(_state(events=(first, second)))
    lines = out.getvalue().splitlines()
    assert lines[0] == "00:01 ! uav2: runs 2.4 s late: slots shifted"
    assert lines[2] == "00:02 · uav3: down"
    assert [line.startswith("07:32 flying | slot 45/150 | 9/51 waypoints") for line in lines] == [
        False,
        True,
        False,
        True,
        True,
    ]


def test_the_line_names_the_worst() -> None:
    """The plain line has the latest UAV, the weakest link and the least energy."""
    line = state_line(_state(uav2=_uav(1, late_s=6.2, energy_left_j=18.0)))
    assert "uav2 6.2 s late" in line
    assert "weakest uav1–uav2 4.1 dB" in line
    assert "energy 10 % (uav2)" in line


def test_a_terminal_keeps_the_last_state() -> None:
    """When the screen is given back, the last state stays on the terminal."""
    out = io.StringIO()
    console = Console(file=out, width=100, height=24, force_terminal=True)
    with FieldScreen(console) as screen:
        screen.show(_state())
    assert "\x1b[?1049l" in out.getvalue()
    after = out.getvalue().rpartition("\x1b[?1049l")[2]
    assert "07:32 of 12:10" in after
