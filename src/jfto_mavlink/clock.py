"""Time, handed in everywhere so that tests and sped-up simulations can bend it."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Protocol

Clock = Callable[[], float]


class PacedClock(Protocol):
    """Seconds as vehicles see them, which pass about `speedup` times faster than on the wall."""

    @property
    def speedup(self) -> float:
        """Seconds of this clock per second of the wall's."""

    def __call__(self) -> float:
        """Seconds since some moment; never goes back."""


@dataclass(frozen=True)
class ScaledClock:
    """Monotonic seconds as a vehicle sees them that runs `speedup` times faster than the wall."""

    speedup: float = 1.0
    _start_s: float = field(default_factory=time.monotonic)

    def __call__(self) -> float:
        """Seconds since the clock was made."""
        return (time.monotonic() - self._start_s) * self.speedup
