"""Time and timers of a replay: they move with the recorded messages, never by themselves."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any


class ReplayClock:
    """The time of a replay, ns since the epoch, and the timers that wait on it."""

    def __init__(self, now_ns: int) -> None:
        self.now_ns = now_ns
        self._timers: list[ReplayTimer] = []

    def add_timer(self, period_ns: int, callback: Callable[[], Any]) -> ReplayTimer:
        """Make a timer that is due a period from now."""
        timer = ReplayTimer(self, period_ns, callback)
        self._timers.append(timer)
        return timer

    def advance(self, until_ns: int) -> None:
        """Run all timers that are due by a time, in the order of their times, then of making."""
        while True:
            due = [t for t in self._timers if t.due_ns is not None and t.due_ns <= until_ns]
            if not due:
                break
            timer = min(due, key=lambda each: each.due_ns or 0)
            self.now_ns = max(self.now_ns, timer.due_ns or 0)
            timer.fire()
        self.now_ns = max(self.now_ns, until_ns)


class ReplayTimer:
    """What nodes use of rclpy's timer."""

    def __init__(self, clock: ReplayClock, period_ns: int, callback: Callable[[], Any]) -> None:
        self._clock = clock
        self._callback = callback
        self.timer_period_ns = period_ns
        self.due_ns: int | None = clock.now_ns + period_ns

    def fire(self) -> None:
        """Call back; the next call is a period later unless the callback says otherwise."""
        assert self.due_ns is not None
        self.due_ns += max(self.timer_period_ns, 1)
        self._callback()

    def reset(self) -> None:
        """Wait a whole period from now."""
        self.due_ns = self._clock.now_ns + self.timer_period_ns

    def cancel(self) -> None:
        """Wait for nothing."""
        self.due_ns = None
