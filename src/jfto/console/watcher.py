"""Progress on a terminal: one bar per running stage, one line per finished one."""

from __future__ import annotations

from types import TracebackType

from rich.console import Console
from rich.markup import escape
from rich.progress import BarColumn, Progress, TaskID, TextColumn, TimeRemainingColumn

_STAGE_WIDTH = 11
_RESULT_WIDTH = 16


class TerminalWatcher:
    """Shows stages on standard error, so that standard output stays the result."""

    def __init__(self, *, quiet: bool = False) -> None:
        self.console = Console(stderr=True, quiet=quiet, highlight=False)
        self._progress = Progress(
            TextColumn("  {task.description}"),
            BarColumn(bar_width=32),
            TextColumn("{task.percentage:3.0f} %"),
            TimeRemainingColumn(compact=True),
            TextColumn("{task.fields[note]}"),
            console=self.console,
            transient=True,
            disable=quiet or not self.console.is_terminal,
        )
        self._task: TaskID | None = None

    def __enter__(self) -> TerminalWatcher:
        self._progress.start()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._clear()
        self._progress.stop()

    def begin(self, stage: str, doing: str) -> None:
        """Start the bar of a stage."""
        self._clear()
        label = f"{stage:<{_STAGE_WIDTH}} {doing}"
        self._task = self._progress.add_task(label, total=1.0, note="")

    def advance(self, fraction: float, note: str = "") -> None:
        """Move the bar."""
        if self._task is not None:
            self._progress.update(self._task, completed=fraction, note=note)

    def end(self, stage: str, result: str, detail: str, *, good: bool = True) -> None:
        """Replace the bar by the line that stays."""
        self._clear()
        mark = "[green]✓[/green]" if good else "[red]✗[/red]"
        line = f"{stage:<{_STAGE_WIDTH}} {result:<{_RESULT_WIDTH}} {detail}"
        self.console.print(f"{mark} {escape(line)}", soft_wrap=True)

    def warn(self, text: str) -> None:
        """Print a line that stays."""
        self.console.print(f"[yellow]![/yellow] {escape(text)}", soft_wrap=True)

    def pause(self) -> None:
        """Leave the terminal to somebody else until `resume`."""
        self._clear()
        self._progress.stop()

    def resume(self) -> None:
        """Have the terminal again."""
        self._progress.start()

    def _clear(self) -> None:
        if self._task is not None:
            self._progress.remove_task(self._task)
            self._task = None
