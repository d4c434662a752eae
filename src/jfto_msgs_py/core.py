"""Pure cores: what decides in flight, knows of time only what it is told, and remembers it."""

from __future__ import annotations

from collections.abc import Callable, Collection, Hashable
from typing import Generic, Protocol, TypeVar

# A clock that is set back by less is no other clock.
SET_BACK_NS = 10**9


class Outputs(Protocol):
    """What a core's step makes."""

    @property
    def wake_ns(self) -> int | None:
        """When the next step is due though no record comes, None where it never is."""


Made = TypeVar("Made", bound=Outputs)
Made_co = TypeVar("Made_co", bound=Outputs, covariant=True)
Record = TypeVar("Record")
Key = TypeVar("Key", bound=Hashable)


class Core(Protocol[Made_co]):
    """Takes records over as they come, by methods that get the time too, and steps when told.

    Times are ns since the epoch.
    """

    def due(self, now_ns: int) -> bool:
        """Whether the records taken over ask for a step; asked after each of them, so quick."""

    def step(self, now_ns: int) -> Made_co:
        """Do what is due; to do it more often changes nothing."""


class CoreRun(Generic[Made]):
    """A core on a clock that its owner moves: the same records at the same times, the same outputs.

    `made` is called with the time and the outputs of each step.
    """

    def __init__(self, core: Core[Made], now_ns: int, made: Callable[[int, Made], object]) -> None:
        self.core = core
        self.now_ns = now_ns
        self._made = made
        self._wake_ns: int | None = None

    def advance(self, until_ns: int) -> None:
        """Let time pass, with all that the core wakes up for; time never goes back."""
        while self._wake_ns is not None and self._wake_ns <= until_ns:
            self.now_ns = max(self.now_ns, self._wake_ns)
            self._wake_ns = None
            self.step()
        self.now_ns = max(self.now_ns, until_ns)

    def hand_over(self, take: Callable[[Record, int], object], record: Record) -> None:
        """Give the core a record by its method `take`; it steps if that makes something due."""
        take(record, self.now_ns)
        if self.core.due(self.now_ns):
            self.step()

    def step(self) -> None:
        """Step now."""
        made = self.core.step(self.now_ns)
        self._wake_ns = made.wake_ns
        self._made(self.now_ns, made)


class ClockWatch:
    """Remembers the latest reading of a clock, to notice that it was set back."""

    def __init__(self) -> None:
        self._last_ns = 0

    def set_back_by_ns(self, now_ns: int) -> int:
        """By how much the clock was set back since the last reading, 0 if it was not."""
        back_ns = self._last_ns - now_ns
        self._last_ns = now_ns
        return back_ns if back_ns > SET_BACK_NS else 0


class Episodes(Generic[Key]):
    """Which troubles are on, each told once; over when absent `clear_after` times in a row."""

    def __init__(self, clear_after: int = 1) -> None:
        self._clear_after = clear_after
        self._absent: dict[Key, int] = {}

    def __contains__(self, key: Key) -> bool:
        return key in self._absent

    def update(self, present: Collection[Key]) -> tuple[list[Key], list[Key]]:
        """Take what is seen now; returns what has begun and what is over."""
        began = [key for key in present if key not in self._absent]
        over = []
        for key in tuple(self._absent):
            self._absent[key] = 0 if key in present else self._absent[key] + 1
            if self._absent[key] >= self._clear_after:
                del self._absent[key]
                over.append(key)
        self._absent.update(dict.fromkeys(began, 0))
        return began, over
