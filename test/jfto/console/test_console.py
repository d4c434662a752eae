"""The console: what stays, and what is drawn in place."""

from __future__ import annotations

import io

import pytest
from rich.console import Console as RichConsole
from rich.text import Text

from jfto.console.console import BAD, Console
from jfto.console.stages import StageProgress

ALTERNATE_SCREEN = "\x1b[?1049h"


def _on(*, terminal: bool) -> tuple[Console, io.StringIO]:
    file = io.StringIO()
    rich = RichConsole(file=file, force_terminal=terminal, width=80, color_system=None)
    return Console(rich=rich), file


def test_lines_stay_as_they_are() -> None:
    """Long lines are not broken, and what looks like markup is text."""
    console, file = _on(terminal=False)
    text = "uav1 [red] " + "x" * 100
    with console:
        console.line(text)
        console.line("lost", BAD)
    assert file.getvalue() == f"{text}\n✗ lost\n"


def test_off_a_terminal_nothing_is_drawn_in_place() -> None:
    """Logs hold lines only."""
    console, file = _on(terminal=False)
    with console:
        console.show(Text("half way"))
        console.show(Text("the whole screen"), screen=True)
    assert file.getvalue() == ""


def test_what_is_drawn_is_replaced_and_taken_away() -> None:
    """A line that comes meanwhile stands above; the screen is given back at the end."""
    console, file = _on(terminal=True)
    with console:
        console.show(Text("half way"))
        console.line("uav1 lost its link")
        console.show(Text("all of it"), screen=True)
        assert ALTERNATE_SCREEN in file.getvalue()
    said = file.getvalue()
    assert said.index("half way") < said.index("uav1 lost its link") < said.index("all of it")
    assert said.endswith("\x1b[?25h\x1b[?1049l")  # the cursor too


def test_stages_leave_one_line_each() -> None:
    """A stage that ended says its figure and its detail; one that failed is marked."""
    console, file = _on(terminal=False)
    with console:
        stages = StageProgress(console)
        stages.begin("routes", "searching")
        stages.advance(0.5, "1.3 km")
        stages.end("routes", "1.34 km", "0 of 44 slot checks violated")
        stages.warn("uav1 is slow")
        stages.begin("power", "exact allocation")
        stages.end("power", "7142 Mb/s", "energy 3–34 % of budget", good=False)
    assert file.getvalue().splitlines() == [
        "✓ routes      1.34 km          0 of 44 slot checks violated",
        "! uav1 is slow",
        "✗ power       7142 Mb/s        energy 3–34 % of budget",
    ]


def test_what_a_stage_does_is_readable_in_80_columns() -> None:
    """No word is cut off; the bar gives way, and lines are folded."""
    doing = "reading the bag, holding it against the plan"
    note = "1.34 km, 12 violations left, 3 rounds to go"
    console, file = _on(terminal=True)
    with console:
        stages = StageProgress(console)
        stages.begin("as flown", doing)
        stages.advance(0.5, note)
        console.show(stages._bars)
        console.rich.print(stages._bars.get_renderable())
    drawn = " ".join(Text.from_ansi(file.getvalue()).plain.split())
    assert "…" not in drawn
    words = set(drawn.split())
    assert set(doing.split()) | set(note.split()) <= words


@pytest.mark.parametrize("quiet", [True, False])
def test_results_and_progress_go_to_different_places(
    capsys: pytest.CaptureFixture[str], *, quiet: bool
) -> None:
    """Standard output is left to the result; quiet means that nothing is said at all."""
    with Console(quiet=quiet) as console:
        console.line("planning")
    said = capsys.readouterr()
    assert said.out == ""
    assert ("planning" in said.err) is not quiet
