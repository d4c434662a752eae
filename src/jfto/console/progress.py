"""How the stages of a run tell whoever is watching what they are doing."""

from __future__ import annotations


class Progress:
    """Follows the stages of a run. This one shows nothing; others override what they show."""

    def begin(self, stage: str, doing: str) -> None:
        """A stage has begun; `doing` says what it does."""

    def advance(self, fraction: float, note: str = "") -> None:
        """The stage is this far, 0 to 1."""

    def end(self, stage: str, result: str, detail: str, *, good: bool = True) -> None:
        """A stage has ended: its main figure and the rest, in words."""

    def warn(self, text: str) -> None:
        """Something that the user should know and that stops nothing."""


SILENT = Progress()
