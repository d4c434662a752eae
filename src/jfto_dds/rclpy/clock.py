"""Clocks: system, steady and ROS time, and callbacks on jumps of time."""

from __future__ import annotations

import enum
import threading
import time
from collections.abc import Callable
from typing import Any

from ._wake_up import WakeUp
from .clock_type import ClockType
from .duration import Duration
from .exceptions import NotInitializedException
from .time import Time
from .utilities import get_default_context

__all__ = [
    "Clock",
    "ClockChange",
    "ClockType",
    "JumpHandle",
    "JumpThreshold",
    "ROSClock",
    "TimeJump",
]


class ClockChange(enum.IntEnum):
    """What a jump did to the source of time."""

    ROS_TIME_NO_CHANGE = 1
    ROS_TIME_ACTIVATED = 2
    ROS_TIME_DEACTIVATED = 3
    SYSTEM_TIME_NO_CHANGE = 4


class JumpThreshold:
    """Which jumps a callback wants to hear of."""

    def __init__(
        self,
        *,
        min_forward: Duration | None,
        min_backward: Duration | None,
        on_clock_change: bool = True,
    ) -> None:
        if min_forward is not None and min_forward.nanoseconds <= 0:
            msg = "min_forward must be a positive non-zero duration"
            raise ValueError(msg)
        if min_backward is not None and min_backward.nanoseconds >= 0:
            msg = "min_backward must be a negative non-zero duration"
            raise ValueError(msg)
        if min_forward is None and min_backward is None and not on_clock_change:
            msg = "At least one jump threshold must be enabled"
            raise ValueError(msg)
        self.min_forward = min_forward
        self.min_backward = min_backward
        self.on_clock_change = on_clock_change

    def _is_met(self, jump: TimeJump) -> bool:
        changed = jump.clock_change in (
            ClockChange.ROS_TIME_ACTIVATED,
            ClockChange.ROS_TIME_DEACTIVATED,
        )
        if changed:
            return self.on_clock_change
        delta = jump.delta.nanoseconds
        if self.min_forward is not None and delta >= self.min_forward.nanoseconds:
            return True
        return self.min_backward is not None and delta <= self.min_backward.nanoseconds


class TimeJump:
    """A jump of ROS time: by how much, and whether its source changed."""

    def __init__(self, clock_change: ClockChange, delta: Duration) -> None:
        self._clock_change = clock_change
        self._delta = delta

    @property
    def clock_change(self) -> ClockChange:
        """What happened to the source of time."""
        return self._clock_change

    @property
    def delta(self) -> Duration:
        """How far time jumped."""
        return self._delta


class JumpHandle:
    """A registered jump callback."""

    def __init__(
        self,
        *,
        clock: Clock,
        threshold: JumpThreshold,
        pre_callback: Callable[[], None] | None,
        post_callback: Callable[[TimeJump], None] | None,
    ) -> None:
        if not (callable(pre_callback) or callable(post_callback)):
            msg = "One of pre_callback or post_callback must be callable"
            raise ValueError(msg)
        self._clock: Clock | None = clock
        self._threshold = threshold
        self._pre_callback = pre_callback
        self._post_callback = post_callback
        clock._jump_handles.append(self)

    def unregister(self) -> None:
        """Stop the callbacks."""
        if self._clock is not None:
            self._clock._jump_handles.remove(self)
            self._clock = None

    def __enter__(self) -> JumpHandle:
        return self

    def __exit__(self, *_exception: object) -> None:
        self.unregister()


class Clock:
    """A source of time of one kind; ``Clock(clock_type=ROS_TIME)`` makes a ROSClock."""

    def __new__(cls, *, clock_type: ClockType = ClockType.SYSTEM_TIME) -> Clock:
        if not isinstance(clock_type, ClockType):
            msg = "Clock type must be a ClockType enum"
            raise TypeError(msg)
        if clock_type is ClockType.ROS_TIME:
            return ROSClock()
        self = object.__new__(cls)
        self._clock_type = clock_type
        self._jump_handles = []
        self._timers = []
        return self

    _clock_type: ClockType
    _jump_handles: list[JumpHandle]
    _timers: list[Any]

    @property
    def clock_type(self) -> ClockType:
        """The kind of this clock."""
        return self._clock_type

    @property
    def handle(self) -> Clock:
        """Stands for rcl's clock."""
        return self

    def __repr__(self) -> str:
        return f"Clock(clock_type={self._clock_type.name})"

    def _now_ns(self) -> int:
        if self._clock_type is ClockType.STEADY_TIME:
            return time.monotonic_ns()
        return time.time_ns()

    @property
    def _follows_wall_time(self) -> bool:
        return True

    def now(self) -> Time:
        """Read the clock."""
        return Time(nanoseconds=self._now_ns(), clock_type=self._clock_type)

    def create_jump_callback(
        self,
        threshold: JumpThreshold,
        *,
        pre_callback: Callable[[], None] | None = None,
        post_callback: Callable[[TimeJump], None] | None = None,
    ) -> JumpHandle:
        """Call back before and after jumps that meet a threshold; ROS time only jumps."""
        return JumpHandle(
            clock=self,
            threshold=threshold,
            pre_callback=pre_callback,
            post_callback=post_callback,
        )

    def sleep_until(self, until: Time, context: Any = None) -> bool:
        """Sleep until a time on this clock.

        Returns False where shutdown or a change of the time source ended the sleep.
        """
        if until.clock_type != self._clock_type:
            msg = "until's clock type does not match this clock's type"
            raise ValueError(msg)
        context = get_default_context() if context is None else context
        if not context.ok():
            text = "Cannot sleep with an invalid context"
            raise NotInitializedException(text)
        wake = WakeUp()
        changes: list[ClockChange] = []

        def jumped(jump: TimeJump) -> None:
            if jump.clock_change is not ClockChange.ROS_TIME_NO_CHANGE:
                changes.append(jump.clock_change)
            wake.set()

        threshold = JumpThreshold(
            min_forward=Duration(nanoseconds=1), min_backward=Duration(nanoseconds=-1)
        )
        context.on_shutdown(wake.set)
        try:
            with self.create_jump_callback(threshold, post_callback=jumped):
                while context.ok() and not changes:
                    left_ns = until.nanoseconds - self._now_ns()
                    if left_ns <= 0:
                        return True
                    if context.ok() and not changes:
                        wake.wait(left_ns / 1e9 if self._follows_wall_time else None)
        finally:
            context._forget(wake.set)
        return False

    def sleep_for(self, rel_time: Duration, context: Any = None) -> bool:
        """Sleep for a span of this clock's time; see :meth:`sleep_until`."""
        return self.sleep_until(self.now() + rel_time, context)


class ROSClock(Clock):
    """A clock that follows ``/clock`` while ROS time is active, else system time."""

    _is_active: bool
    _override_ns: int
    _jump_lock: Any

    def __new__(cls) -> ROSClock:
        self = object.__new__(cls)
        self._clock_type = ClockType.ROS_TIME
        self._jump_handles = []
        self._timers = []
        self._is_active = False
        self._override_ns = 0
        self._jump_lock = threading.RLock()
        return self

    @property
    def ros_time_is_active(self) -> bool:
        """Whether time comes from ``/clock``."""
        return self._is_active

    @property
    def _follows_wall_time(self) -> bool:
        return not self._is_active

    def _now_ns(self) -> int:
        return self._override_ns if self._is_active else time.time_ns()

    def _jump(self, jump: TimeJump, apply: Callable[[], None]) -> None:
        with self._jump_lock:
            concerned = [h for h in tuple(self._jump_handles) if h._threshold._is_met(jump)]
            timers = tuple(self._timers)
            for handle in concerned:
                if handle._pre_callback is not None:
                    handle._pre_callback()
            for timer in timers:
                timer._before_jump(jump)
            apply()
            for timer in timers:
                timer._after_jump(jump)
            for handle in concerned:
                if handle._post_callback is not None:
                    handle._post_callback(jump)

    def _set_ros_time_is_active(self, enabled: bool) -> None:
        if enabled == self._is_active:
            return
        change = ClockChange.ROS_TIME_ACTIVATED if enabled else ClockChange.ROS_TIME_DEACTIVATED

        def apply() -> None:
            self._is_active = enabled

        self._jump(TimeJump(change, Duration()), apply)

    def set_ros_time_override(self, time: Time) -> None:
        """Set the time that is read while ROS time is active."""
        if not isinstance(time, Time):
            msg = "Time must be specified as rclpy.time.Time"
            raise TypeError(msg)

        def apply() -> None:
            self._override_ns = time.nanoseconds

        if not self._is_active:
            apply()
            return
        delta = Duration(nanoseconds=time.nanoseconds - self._override_ns)
        self._jump(TimeJump(ClockChange.ROS_TIME_NO_CHANGE, delta), apply)
