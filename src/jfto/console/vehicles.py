"""Conversations with several vehicles on the console: a bar each, what happens as lines above."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from rich.progress import BarColumn, MofNCompleteColumn, TaskID, TextColumn
from rich.progress import Progress as Bars
from rich.table import Column

from jfto.console.console import Console

if TYPE_CHECKING:
    from jfto_mavlink.protocol.exchange import Report


class VehicleProgress:
    """Shows on `console` where each conversation stands; `report` is called for each step."""

    def __init__(self, console: Console) -> None:
        self.console = console
        self._bars = Bars(
            TextColumn("{task.fields[uav]:<8}"),
            BarColumn(24),
            MofNCompleteColumn(),
            TextColumn(
                "{task.description}",
                markup=False,
                table_column=Column(no_wrap=False, overflow="fold"),
            ),
            console=console.rich,
        )
        self._tasks: dict[str, TaskID] = {}

    def report(self, uav: str, report: Report) -> None:
        """Show a step; one that is not counted is kept as a line."""
        if uav not in self._tasks:
            self._tasks[uav] = self._bars.add_task("", uav=uav, total=1)
            self.console.show(self._bars)
        task = self._tasks[uav]
        if report.total:
            self._bars.update(
                task, description=report.text, completed=report.done, total=report.total
            )
            return
        self.console.line(f"{uav:<8} {report.text}")
        self._bars.update(task, description=report.text)


@contextmanager
def show_vehicles() -> Iterator[VehicleProgress]:
    """Progress on a console of its own."""
    with Console() as console:
        yield VehicleProgress(console)
