"""The screen of a flight: what an operator reads off it, on any terminal."""

from __future__ import annotations

import io
from dataclasses import replace

import pytest
from rich.console import Console as RichConsole

from jfto.console.console import Console
from jfto.flight.screen import texts
from jfto.flight.screen.screen import LINE_EVERY_S, FlightScreen, state_line
from jfto.flight.screen.selection import shown_events
from jfto.flight.screen.state import (
    FLYING,
    LANDED,
    PAD,
    SILENT,
    FlightState,
    LinkState,
    UavState,
)
from jfto.flight.screen.view import FlightView
from jfto_msgs_py.records.event import ERROR, INFO, WARN, Event


def _uav(index: int, **changes: object) -> UavState:
    links = (LinkState(f"uav{index + 2}", 4.1), LinkState(f"uav{index + 3}", 9.3))
    plain = UavState(f"uav{index + 1}", index, FLYING, 3, 17, 8.0, 0.2, 90.0, 180.0, links=links)
    return replace(plain, **changes)  # type: ignore[arg-type]


def _state(count: int = 3, events: tuple[Event, ...] = (), **changes: UavState) -> FlightState:
    uavs = tuple(changes.get(f"uav{index + 1}", _uav(index)) for index in range(count))
    return FlightState("demo", "flying", 452.0, 730.0, 45, 150, 2, 1, uavs, events, 0)


def _event(at_s: float, level: int, uav: str, kind: str, text: str) -> Event:
    return Event(level, kind, uav, text, round(at_s * 1e9), "node")


def _drawn(state: FlightState, width: int = 100, height: int = 24) -> list[str]:
    console = RichConsole(file=io.StringIO(), width=width, height=height, force_terminal=True)
    with console.capture() as capture:
        console.print(FlightView(state))
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
    links = (LinkState("uav9", -0.6), LinkState("uav8", 0.4), LinkState("uav7", 7.0))
    alone = (LinkState("uav7", 3.0),)
    lines = _drawn(_state(uav1=_uav(0, links=links), uav2=_uav(1, links=alone)))
    assert "uav9 -0.6✗  uav8 0.4!  uav7 7.0" in _row(lines, "uav1")
    assert "✗ 1 of 2" in _row(lines, "uav2")
    said = "✓ all linked by way of others; ✗ uav1–uav9 down   weakest uav1–uav8 0.4! dB"
    assert any(said in line for line in lines)


def test_without_links_it_is_said_why() -> None:
    """Before the first, after the last, and for a fleet of one."""
    waits = tuple(_uav(k, phase=PAD, links=()) for k in range(3))
    state = replace(_state(), parts=0, uavs=waits)
    assert texts.network(state).plain == "no links yet"
    down = replace(state, uavs=tuple(replace(uav, phase=LANDED) for uav in waits))
    assert texts.network(down).plain == "all down: links are no longer needed"
    one = replace(state, uavs=(replace(waits[0], phase=FLYING),), parts=1)
    assert texts.network(one).plain == "fleet of one: no links"


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
        _event(float(k), WARN, "uav1", f"kind{k}", ("something long happened " * 8).strip())
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
    dead = _event(1.0, ERROR, "uav4", "radio", "radio dead")
    late = _event(2.0, WARN, "uav2", "late", "late")
    notes = [_event(3.0 + k, INFO, "uav1", "link", f"note {k}") for k in range(50)]
    kept, older = shown_events([dead, late, late, *notes], 4)
    assert [one.text for one in kept] == ["radio dead", "late", "note 48", "note 49"]
    assert older == 49


def test_off_a_terminal_events_come_once_and_a_line_now_and_then() -> None:
    """Each event is one line, at once; how things stand is a line every ten seconds."""
    out = io.StringIO()
    now = [0.0]
    first = _event(1.0, WARN, "uav2", "late", "runs 2.4 s late: slots shifted")
    second = _event(2.0, INFO, "uav3", "landed", "down")
    screen = FlightScreen(Console(rich=RichConsole(file=out, width=200)), lambda: now[0])
    screen.show(_state(events=(first,)))
    now[0] = LINE_EVERY_S / 2
    screen.show(_state(events=(first, second)))
    now[0] = LINE_EVERY_S
    screen.show(_state(events=(first, second)))
    screen.close()
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
    rich = RichConsole(file=out, width=100, height=24, force_terminal=True)
    screen = FlightScreen(Console(rich=rich))
    screen.show(_state())
    screen.close()
    assert "\x1b[?1049l" in out.getvalue()
    after = out.getvalue().rpartition("\x1b[?1049l")[2]
    assert "07:32 of 12:10" in after


def test_what_was_told_before_the_flight_is_not_told_again() -> None:
    """A line of the operator's own that comes back as an event would stand there twice."""
    out = io.StringIO()
    screen = FlightScreen(Console(rich=RichConsole(file=out, width=200)), lambda: 0.0)
    screen.told("3 vehicles\nlinked")
    linked = _event(-9.0, INFO, "", "order", "3 vehicles linked")
    screen.show(_state(events=(linked, _event(0.0, INFO, "", "lift_off", "Lift-off."))))
    assert "linked" not in out.getvalue().partition("|")[0]
    assert "Lift-off." in out.getvalue()


def test_why_something_went_wrong_is_said_in_full() -> None:
    """The newest trouble is never cut off; notes give way to it."""
    why = "uav2 refused to arm: " + "the compass is not healthy, " * 12 + "so says the autopilot"
    notes = tuple(_event(2.0 + k, INFO, "uav1", "link", f"note {k}") for k in range(30))
    lines = _drawn(_state(6, (_event(1.0, ERROR, "uav2", "order", why), *notes)), 80, 24)
    assert len(lines) <= 24
    assert why in " ".join(" ".join(line.strip() for line in lines).split())
    assert any("note 29" in line for line in lines)
