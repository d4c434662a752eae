"""Time, handed in everywhere so that tests and sped-up simulations can bend it."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field

Clock = Callable[[], float]


@dataclass(frozen=True)
class ScaledClock:
    """Monotonic seconds as a vehicle sees them that runs `speedup` times faster than the wall."""

    speedup: float = 1.0
    _start_s: float = field(default_factory=time.monotonic)

    def __call__(self) -> float:
        """Seconds since the clock was made."""
        return (time.monotonic() - self._start_s) * self.speedup
