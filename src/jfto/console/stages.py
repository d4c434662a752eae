"""Stages of a run on the console: one bar for the running one, one line for each that ended."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from rich.progress import BarColumn, TaskID, TextColumn, TimeRemainingColumn
from rich.progress import Progress as Bars
from rich.table import Column

from jfto.console.console import BAD, GOOD, WARNING, Console
from jfto.console.progress import Progress

_STAGE_WIDTH = 11
_RESULT_WIDTH = 16
# Below this a full bar leaves no room for what is said beside it.
_WIDE = 110


class StageProgress(Progress):
    """Shows stages on `console`; what is shown in between by others is theirs to hide."""

    def __init__(self, console: Console) -> None:
        self.console = console
        self._bars = Bars(
            # Words before bars: a narrow terminal gets a shorter bar, and its lines are folded.
            TextColumn("  {task.description}", table_column=_folded()),
            BarColumn(bar_width=32 if console.rich.width >= _WIDE else 8),
            TextColumn("{task.percentage:3.0f} %"),
            TimeRemainingColumn(compact=True),
            TextColumn("{task.fields[note]}", markup=False, table_column=_folded()),
            console=console.rich,
        )
        self._task: TaskID | None = None

    def begin(self, stage: str, doing: str) -> None:
        """Start the bar of a stage."""
        self._forget()
        label = f"{stage:<{_STAGE_WIDTH}} {doing}"
        self._task = self._bars.add_task(label, total=1.0, note="")
        self.console.show(self._bars)

    def advance(self, fraction: float, note: str = "") -> None:
        """Move the bar."""
        if self._task is not None:
            self._bars.update(self._task, completed=fraction, note=note)

    def end(self, stage: str, result: str, detail: str, *, good: bool = True) -> None:
        """Replace the bar by the line that stays."""
        self._forget()
        self.console.hide()
        line = f"{stage:<{_STAGE_WIDTH}} {result:<{_RESULT_WIDTH}} {detail}"
        self.console.line(line, GOOD if good else BAD)

    def warn(self, text: str) -> None:
        """Print a line that stays."""
        self.console.line(text, WARNING)

    def _forget(self) -> None:
        if self._task is not None:
            self._bars.remove_task(self._task)
            self._task = None


def _folded() -> Column:
    return Column(no_wrap=False, overflow="fold")


@contextmanager
def show_stages(*, quiet: bool = False) -> Iterator[StageProgress]:
    """Stages on a console of their own; with `quiet` nothing is shown."""
    with Console(quiet=quiet) as console:
        yield StageProgress(console)
