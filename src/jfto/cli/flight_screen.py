"""Progress of several vehicles on a terminal: one line each, events above them."""

from __future__ import annotations

from types import TracebackType
from typing import TYPE_CHECKING

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TaskID, TextColumn

if TYPE_CHECKING:
    from jfto_mavlink.protocol.exchange import Report
    from jfto_msgs_py.records.event import Event


class FlightScreen:
    """A bar per vehicle with its last words. Off a terminal, only what happens is printed."""

    def __init__(self) -> None:
        self.console = Console()
        self._progress = Progress(
            TextColumn("{task.fields[uav]:<8}"),
            BarColumn(24),
            MofNCompleteColumn(),
            TextColumn("{task.description}", markup=False),
            console=self.console,
            disable=not self.console.is_terminal,
        )
        self.events: list[Event] = []
        self._tasks: dict[str, TaskID] = {}

    def __enter__(self) -> FlightScreen:
        self._progress.start()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._progress.stop()

    def report(self, uav: str, report: Report) -> None:
        """Show where a conversation stands; what is not counted in steps is kept as a line."""
        if uav not in self._tasks:
            self._tasks[uav] = self._progress.add_task("", uav=uav, total=1)
        total = report.total or None
        if total is None:
            self.console.print(f"{uav:<8} {report.text}", markup=False, highlight=False)
            self._progress.update(self._tasks[uav], description=report.text)
            return
        if report.text.startswith("waypoint"):
            self.console.print(f"{uav:<8} {report.text}", markup=False, highlight=False)
        self._progress.update(
            self._tasks[uav], description=report.text, completed=report.done, total=total
        )

    def event(self, event: Event) -> None:
        """Print an event; warnings and worse are marked."""
        from jfto_msgs_py.records.event import INFO

        self.events.append(event)
        mark = "!" if event.level > INFO else " "
        self.console.print(f"{event.uav_id:<8}{mark}{event.text}", markup=False, highlight=False)
