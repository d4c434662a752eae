"""Timers that call back, and rates that sleep."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Any

from ._rclpy_pybind11 import DESTROYED_TEXT, RCLError
from ._wake_up import WakeUp
from .clock import ClockChange
from .exceptions import InvalidHandle, ROSInterruptException

_CHANGES = (ClockChange.ROS_TIME_ACTIVATED, ClockChange.ROS_TIME_DEACTIVATED)


class Timer:
    """Calls back each time its period has passed on its clock; missed calls are not made up."""

    def __init__(
        self,
        callback: Callable[[], Any] | None,
        callback_group: Any,
        timer_period_ns: int,
        clock: Any,
        *,
        wake: Callable[[], None],
        autostart: bool = True,
    ) -> None:
        if timer_period_ns < 0:
            msg = "failed to create timer: timer period must be non-negative"
            raise RCLError(msg)
        self.callback = callback
        self.callback_group = callback_group
        self._clock = clock
        self._period_ns = timer_period_ns
        self._wake = wake
        self._canceled = not autostart
        self._destroyed = False
        self._lock = threading.RLock()
        self._credit_ns: int | None = None
        self._last_ns = clock._now_ns()
        self._next_ns = self._last_ns + timer_period_ns
        clock._timers.append(self)

    def _require(self) -> None:
        if self._destroyed:
            raise InvalidHandle(DESTROYED_TEXT)

    @property
    def handle(self) -> Timer:
        """Stands for rcl's timer."""
        return self

    @property
    def clock(self) -> Any:
        """The clock that the timer follows."""
        return self._clock

    @property
    def timer_period_ns(self) -> int:
        """The period in nanoseconds; a new one counts from the next call on."""
        self._require()
        return self._period_ns

    @timer_period_ns.setter
    def timer_period_ns(self, value: int) -> None:
        self._require()
        self._period_ns = int(value)

    def is_ready(self) -> bool:
        """Whether the callback is due."""
        self._require()
        return self._is_ready()

    def _is_ready(self) -> bool:
        return not self._canceled and not self._destroyed and self._next_ns <= self._clock._now_ns()

    def _wall_wait_s(self) -> float | None:
        """Seconds until due; None where only a jump of simulated time or nobody can tell."""
        if self._canceled or self._destroyed or not self._clock._follows_wall_time:
            return None
        return (self._next_ns - self._clock._now_ns()) / 1e9

    def _take(self) -> Callable[[], Any] | None:
        with self._lock:
            if not self._is_ready():
                return None
            now_ns = self._clock._now_ns()
            self._last_ns = now_ns
            self._next_ns += self._period_ns
            if self._next_ns < now_ns:
                if self._period_ns == 0:
                    self._next_ns = now_ns
                else:
                    missed = 1 + (now_ns - self._next_ns) // self._period_ns
                    self._next_ns += missed * self._period_ns
        return self.callback

    def is_canceled(self) -> bool:
        """Whether the timer is stopped."""
        self._require()
        return self._canceled

    def cancel(self) -> None:
        """Stop the timer."""
        self._require()
        self._canceled = True

    def reset(self) -> None:
        """Start anew: the next call is one period from now."""
        self._require()
        with self._lock:
            self._canceled = False
            self._next_ns = self._clock._now_ns() + self._period_ns
        self._wake()

    def time_since_last_call(self) -> int:
        """Nanoseconds since the last call, or since creation."""
        self._require()
        return self._clock._now_ns() - self._last_ns

    def time_until_next_call(self) -> int | None:
        """Nanoseconds until the callback is due; None for a stopped timer."""
        self._require()
        return None if self._canceled else self._next_ns - self._clock._now_ns()

    def destroy(self) -> None:
        """Stop for good."""
        self._destroyed = True
        if self in self._clock._timers:
            self._clock._timers.remove(self)

    def _before_jump(self, jump: Any) -> None:
        now_ns = self._clock._now_ns()
        # Without a reading of the clock there is no credit to carry over.
        if jump.clock_change in _CHANGES and now_ns:
            self._credit_ns = self._next_ns - now_ns

    def _after_jump(self, jump: Any) -> None:
        with self._lock:
            now_ns = self._clock._now_ns()
            if jump.clock_change in _CHANGES:
                credit_ns, self._credit_ns = self._credit_ns, None
                if now_ns and credit_ns:
                    self._next_ns = now_ns - credit_ns + self._period_ns
                    self._last_ns = now_ns - credit_ns
            elif self._next_ns > now_ns and now_ns < self._last_ns:
                # Further back than the last call: count one period from here.
                self._next_ns = now_ns + self._period_ns
                self._last_ns = now_ns
        self._wake()


class Rate:
    """Sleeps so that a loop runs at a frequency; some other thread must spin the node."""

    def __init__(self, timer: Timer, *, context: Any) -> None:
        self._timer = timer
        self._clock = timer.clock
        self._is_shutdown = False
        self._is_destroyed = False
        self._lock = threading.Lock()
        self._sleepers: list[WakeUp] = []
        self._elapsed = False
        timer.callback = self._tick
        context.on_shutdown(self._on_shutdown)

    def _wake_all(self) -> None:
        for sleeper in tuple(self._sleepers):
            sleeper.set()

    def _tick(self) -> None:
        with self._lock:
            self._elapsed = not self._sleepers
            self._wake_all()

    def _on_shutdown(self) -> None:
        self._is_shutdown = True
        self._wake_all()

    def destroy(self) -> None:
        """Wake whoever sleeps; sleeping again is an error."""
        self._is_destroyed = True
        self._wake_all()

    def sleep(self) -> None:
        """Sleep until the timer fires; returns at once where it fired since the last sleep.

        Raises
        ------
        ROSInterruptException
            The context is shut down.
        RuntimeError
            The rate was destroyed.
        """
        if self._is_shutdown:
            raise ROSInterruptException
        if self._is_destroyed:
            msg = "Rate cannot sleep because it has been destroyed"
            raise RuntimeError(msg)
        sleeper = WakeUp()
        with self._lock:
            if self._elapsed:
                self._elapsed = False
                return
            self._sleepers.append(sleeper)
        if not (self._is_shutdown or self._is_destroyed):
            sleeper.wait()
        with self._lock:
            self._sleepers.remove(sleeper)
        if self._is_shutdown:
            raise ROSInterruptException
