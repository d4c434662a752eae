"""Creating and destroying what a node does without the network: timers, rates, guards."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from ._rclpy_pybind11 import RCLError
from .constants import S_TO_NS
from .guard_condition import GuardCondition
from .timer import Rate, Timer


class NodeTiming:
    """Timing part of :class:`rclpy.node.Node`."""

    _context: Any
    _clock: Any
    _default_callback_group: Any
    _rate_group: Any
    _timers: list[Timer]
    _guards: list[GuardCondition]
    _destroy_from: Callable[[list[Any], Any], bool]
    _wake_executor: Callable[[], None]

    def create_timer(
        self,
        timer_period_sec: float,
        callback: Callable[[], Any] | None,
        callback_group: Any = None,
        clock: Any = None,
        autostart: bool = True,
    ) -> Timer:
        """Create a timer on the node's clock, or on another one."""
        if not self._context.ok():
            msg = "failed to create timer: the given context is not valid"
            raise RCLError(msg)
        group = callback_group or self._default_callback_group
        timer = Timer(
            callback,
            group,
            int(float(timer_period_sec) * S_TO_NS),
            self._clock if clock is None else clock,
            wake=self._wake_executor,
            autostart=autostart,
        )
        group.add_entity(timer)
        self._timers.append(timer)
        self._wake_executor()
        return timer

    def create_guard_condition(
        self, callback: Callable[[], Any] | None, callback_group: Any = None
    ) -> GuardCondition:
        """Create a guard condition."""
        group = callback_group or self._default_callback_group
        guard = GuardCondition(callback, group, self._wake_executor)
        group.add_entity(guard)
        self._guards.append(guard)
        self._wake_executor()
        return guard

    def create_rate(self, frequency: float, clock: Any = None) -> Rate:
        """Create a rate, which sleeps so that a loop runs at ``frequency`` (Hz)."""
        if frequency <= 0:
            msg = "frequency must be > 0"
            raise ValueError(msg)
        timer = self.create_timer(1.0 / frequency, None, self._rate_group, clock)
        return Rate(timer, context=self._context)

    def destroy_timer(self, timer: Timer) -> bool:
        """Destroy a timer; False where it is none of this node's."""
        return self._destroy_from(self._timers, timer)

    def destroy_guard_condition(self, guard: GuardCondition) -> bool:
        """Destroy a guard condition; False where it is none of this node's."""
        return self._destroy_from(self._guards, guard)

    def destroy_rate(self, rate: Rate) -> bool:
        """Destroy a rate and wake who sleeps in it."""
        rate.destroy()
        return self.destroy_timer(rate._timer)
