"""Nothing that is not simulated arms without a word."""

from __future__ import annotations

import io
import sys

import pytest
from rich.console import Console as RichConsole

from jfto.console.console import Console
from jfto.flight.operator import ConsoleOperator, require_confirmation
from jfto_msgs_py.errors import InputError


def test_without_a_terminal_real_vehicles_need_arm(monkeypatch) -> None:
    """Said before anything is done, with the cure."""
    monkeypatch.setattr(sys, "stdin", io.StringIO())
    with pytest.raises(InputError, match="Give --arm, or look first with --until arm"):
        require_confirmation(simulated=False, armed=False)


@pytest.mark.parametrize(("simulated", "armed"), [(True, False), (False, True)])
def test_simulated_vehicles_and_a_word_given_ahead_need_no_terminal(
    monkeypatch, simulated, armed
) -> None:
    """Both fly from a script."""
    monkeypatch.setattr(sys, "stdin", io.StringIO())
    assert require_confirmation(simulated=simulated, armed=armed) is None


@pytest.mark.parametrize(
    ("typed", "arms"),
    [("arm\n", True), (" ARM \n", True), ("\n", False), ("yes\n", False), ("", False)],
)
def test_the_word_has_to_be_typed(monkeypatch, tmp_path, typed, arms) -> None:
    """Enter alone, or anything but the word, arms nothing."""
    (tmp_path / "keys").write_text(typed)
    screen = RichConsole(file=io.StringIO(), width=100)
    with (tmp_path / "keys").open() as keys:
        monkeypatch.setattr(sys, "stdin", keys)
        assert ConsoleOperator(Console(rich=screen), 3).ask(lambda: True) is arms
    assert "Type arm to arm 3 vehicles" in screen.file.getvalue()


def test_the_question_ends_when_the_graph_does() -> None:
    """A died bridge or Ctrl-C while the operator thinks."""
    assert ConsoleOperator(Console(quiet=True), 3).ask(lambda: False) is False
