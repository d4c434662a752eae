"""Noticing that a clock was set back."""

from __future__ import annotations

# A clock that is set back by less is no other clock.
SET_BACK_NS = 10**9


class ClockWatch:
    """Remembers the latest reading of a clock."""

    def __init__(self) -> None:
        self._last_ns = 0

    def set_back_by_ns(self, now_ns: int) -> int:
        """By how much the clock was set back since the last reading, 0 if it was not."""
        back_ns = self._last_ns - now_ns
        self._last_ns = now_ns
        return back_ns if back_ns > SET_BACK_NS else 0
