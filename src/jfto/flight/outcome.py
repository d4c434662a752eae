"""What comes of a conducted flight."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum


class Ending(Enum):
    """How it ended.

    `DRY`: as far as was wanted, nothing armed. `LANDED`: flown, all down. `REFUSED`: nobody flew.
    `ABORTED`: called home, all down. `LOST`: not all are known to be down. `LEFT`: the operator
    left while vehicles were on their way home.
    """

    DRY = "dry run"
    LANDED = "landed"
    REFUSED = "refused"
    ABORTED = "aborted"
    LOST = "lost"
    LEFT = "left"


@dataclass(frozen=True)
class Outcome:
    """The ending, and one line that says what happened and in which state everything is.

    `interrupted` says that the operator wanted it, `flown` that vehicles were told to start.
    """

    ending: Ending
    text: str
    interrupted: bool = False
    flown: bool = False

    @property
    def good(self) -> bool:
        """Whether it went as planned."""
        return self.ending in {Ending.DRY, Ending.LANDED} and not self.interrupted
