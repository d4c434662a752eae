"""The one console: lines that stay, and below them one thing that is drawn again as it changes."""

from __future__ import annotations

from types import TracebackType

from rich.console import Console as RichConsole
from rich.console import RenderableType
from rich.live import Live
from rich.markup import escape

GOOD, BAD, WARNING, NOTE = (
    "[green]✓[/green]",
    "[red]✗[/red]",
    "[yellow]![/yellow]",
    "[green]·[/green]",
)

TABLE_WIDTH = 130


class Console:
    """What a command says while it works; use it as a context manager.

    It writes to standard error, so that standard output stays the result; with `quiet` nowhere.
    `rich` is another console of Rich to write to.
    """

    def __init__(self, *, quiet: bool = False, rich: RichConsole | None = None) -> None:
        self.rich = rich or RichConsole(stderr=True, quiet=quiet, highlight=False)
        self._live: Live | None = None
        self._screen = False

    def __enter__(self) -> Console:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.hide()

    @property
    def is_terminal(self) -> bool:
        """Whether anything can be drawn in place; elsewhere only lines are of use."""
        return self.rich.is_terminal and not self.rich.quiet

    def line(self, text: str, mark: str = "") -> None:
        """A line that stays, behind one of the marks above; long ones are not broken."""
        self.rich.print(f"{mark} {escape(text)}" if mark else escape(text), soft_wrap=True)

    def table(self, what: RenderableType) -> None:
        """A table that stays; off a terminal it is as wide as reads well in a file."""
        if not self.rich.is_terminal:
            self.rich.width = max(self.rich.width, TABLE_WIDTH)
        self.rich.print(what)

    def show(self, what: RenderableType, *, screen: bool = False) -> None:
        """Draw `what` below the lines, in place of what was there; nothing off a terminal.

        With `screen` it has the whole terminal until it is hidden, and is drawn when shown only;
        else ten times a second, so that bars and clocks in it move.
        """
        if not self.is_terminal:
            return
        if self._live is not None and screen == self._screen:
            self._live.update(what, refresh=True)
            return
        self.hide()
        self._screen = screen
        self._live = Live(
            what,
            console=self.rich,
            screen=screen,
            transient=True,
            auto_refresh=not screen,
            refresh_per_second=10,
        )
        self._live.start(refresh=True)

    def hide(self) -> None:
        """Take away what is drawn; lines stay."""
        if self._live is not None:
            self._live.stop()
            self._live = None
