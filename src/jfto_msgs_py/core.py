"""Pure cores: what decides in flight, knowing of time only what it is told."""

from __future__ import annotations

from collections.abc import Callable
from typing import Generic, Protocol, TypeVar


class Outputs(Protocol):
    """What a core's step makes."""

    @property
    def wake_ns(self) -> int | None:
        """When the next step is due though no record comes, None where it never is."""


Made = TypeVar("Made", bound=Outputs)
Made_co = TypeVar("Made_co", bound=Outputs, covariant=True)
Record = TypeVar("Record")


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
