"""Time: the clocks that are handed in everywhere, round trips, and a vehicle's clock against ours.

Clocks are handed in so that tests and sped-up simulations can bend them; round trips follow RFC
6298; offsets come from TIMESYNC and SYSTEM_TIME.
"""

from __future__ import annotations

import time
from collections import deque
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


@dataclass
class RoundTrip:
    """Smoothed round-trip time in seconds and the time-out derived from it.

    `floor_s` covers the autopilot's own reaction (2 to 11 ms measured) and a busy computer.
    """

    smoothed_s: float | None = None
    variation_s: float = 0.0
    floor_s: float = 0.08
    ceiling_s: float = 2.0
    initial_s: float = 0.5

    def measure(self, sample_s: float) -> None:
        """Take in one measured round trip."""
        if sample_s < 0:
            return
        if self.smoothed_s is None:
            self.smoothed_s, self.variation_s = sample_s, sample_s / 2
            return
        self.variation_s += (abs(sample_s - self.smoothed_s) - self.variation_s) / 4
        self.smoothed_s += (sample_s - self.smoothed_s) / 8

    @property
    def timeout_s(self) -> float:
        """How long an answer may take before the question is asked again."""
        if self.smoothed_s is None:
            return self.initial_s
        wanted = self.smoothed_s + 4 * self.variation_s
        return min(max(wanted, self.floor_s), self.ceiling_s)


NS = 1_000_000_000
# Samples among which the one with the shortest round trip is believed.
WINDOW = 16
# A vehicle's clock that is this much behind, beyond any delay, has started again.
BACK_S = 1.0
# Up to this age of its clock a vehicle can have booted again without the clock reading less.
YOUNG_S = 20.0


@dataclass
class TimeSync:
    """Offset of the vehicle's boot clock, round trip and jitter, all in seconds.

    `offset_s` is vehicle minus station; the sample with the shortest round trip among the last
    ones is used, since delay adds to the error on one side only. `jitter_s` is the mean absolute
    deviation of the offsets in the window.
    """

    round_trip: RoundTrip = field(default_factory=RoundTrip)
    utc_error_s: float | None = None
    samples: int = 0
    _last: tuple[float, float] | None = None
    _window: deque[tuple[float, float]] = field(default_factory=lambda: deque(maxlen=WINDOW))

    def answer(self, sent_ns: int, vehicle_ns: int, now_ns: int) -> bool:
        """Take in the answer to our TIMESYNC; one that cannot be ours is ignored.

        Returns whether the vehicle's clock has gone back, which is a reboot.
        """
        rtt_s = (now_ns - sent_ns) / NS
        if not 0 <= rtt_s < 10:
            return False
        our_s, vehicle_s = (sent_ns + now_ns) / 2 / NS, vehicle_ns / NS
        back = self._back(our_s, vehicle_s, rtt_s + BACK_S)
        if back:
            self.restart()
        self._last = (our_s, vehicle_s)
        self.round_trip.measure(rtt_s)
        self._window.append((rtt_s, vehicle_s - our_s))
        self.samples += 1
        return back

    def system_time(self, vehicle_unix_us: int, our_unix_s: float) -> None:
        """Take in SYSTEM_TIME; 0 means that the vehicle has no UTC yet."""
        if vehicle_unix_us:
            one_way = (self.round_trip.smoothed_s or 0.0) / 2
            self.utc_error_s = vehicle_unix_us / 1e6 + one_way - our_unix_s

    def restart(self) -> None:
        """Forget the offset: the vehicle has booted again."""
        self._window.clear()
        self._last = None
        self.utc_error_s = None

    def _back(self, our_s: float, vehicle_s: float, tolerance_s: float) -> bool:
        """Whether the vehicle's clock went back since its last answer.

        Soon after a boot the new clock may already have passed the old one; then falling behind
        ours tells. Later it does not: a simulation may stall, in the air as well.
        """
        if self._last is None:
            return False
        expected_s = self._last[1]
        if expected_s < YOUNG_S:
            expected_s += max(our_s - self._last[0], 0.0) * 2 / 3
        return vehicle_s + tolerance_s < expected_s

    @property
    def offset_s(self) -> float | None:
        """Vehicle clock minus ours, None before the first answer."""
        return min(self._window)[1] if self._window else None

    @property
    def jitter_s(self) -> float:
        """Mean absolute deviation of the offsets from the one believed."""
        best = self.offset_s
        if best is None:
            return 0.0
        return sum(abs(offset - best) for _, offset in self._window) / len(self._window)
