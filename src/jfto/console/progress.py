"""How the pipeline tells whoever is watching what it is doing."""

from __future__ import annotations

from typing import Protocol


class Watcher(Protocol):
    """Follows the stages of a run."""

    def begin(self, stage: str, doing: str) -> None:
        """A stage has begun; `doing` says what it does."""

    def advance(self, fraction: float, note: str = "") -> None:
        """The stage is this far, 0 to 1."""

    def end(self, stage: str, result: str, detail: str, *, good: bool = True) -> None:
        """A stage has ended: its main figure and the rest, in words."""

    def warn(self, text: str) -> None:
        """Something that the user should know and that stops nothing."""


class SilentWatcher:
    """A watcher that shows nothing."""

    def begin(self, stage: str, doing: str) -> None:
        """Ignore."""

    def advance(self, fraction: float, note: str = "") -> None:
        """Ignore."""

    def end(self, stage: str, result: str, detail: str, *, good: bool = True) -> None:
        """Ignore."""

    def warn(self, text: str) -> None:
        """Ignore."""
