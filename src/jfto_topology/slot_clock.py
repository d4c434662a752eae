"""When the slots of a mission begin, on a fleet that runs late."""

from __future__ import annotations

import numpy as np

# By how much of a slot one slot may be longer or shorter than planned.
_STRETCH = 0.25


class SlotClock:
    """Slots that shift in time with the fleet; knows no clock of its own.

    As long as the fleet is on time, slot n begins n slot lengths after `start_ns`. Where it lags,
    each slot ends later, by a quarter of its length at most, until slots and fleet agree; a fleet
    that is held up for longer repeats its slot, one that catches up may skip one. Slots never go
    back, and one begins every 0.75 to 1.25 slot lengths whatever the lag is said to be.

    `slot` is the current one, -1 before the first; it began at `begin_ns`, `shift_s` seconds later
    than planned (as it was at the end of the mission, after that). Times are ns since the epoch.
    """

    def __init__(self, start_ns: int, slot_count: int, duration_s: float) -> None:
        self.slot = -1
        self.begin_ns = start_ns
        self.shift_s = 0.0
        self._start_ns = start_ns
        self._slot_count = slot_count
        self._length_ns = round(duration_s * 1e9)

    def is_young(self, now_ns: int) -> bool:
        """Whether the current slot cannot be over, whatever the lag."""
        young = now_ns < self.begin_ns + round((1 - _STRETCH) * self._length_ns)
        return young and not self._lost(now_ns)

    def next_ns(self, now_ns: int, lag_s: float | None) -> int:
        """When the next slot begins, for a fleet that lags by `lag_s` (None: nobody knows)."""
        if self._lost(now_ns):
            return self._anchored(now_ns, lag_s)[1]
        limit_s = _STRETCH * self._length_ns / 1e9
        error_s = 0.0 if lag_s is None else float(np.clip(lag_s - self.shift_s, -limit_s, limit_s))
        if self.slot >= self._slot_count:
            error_s = 0.0
        return self.begin_ns + self._length_ns + round(error_s * 1e9)

    def advance(self, now_ns: int, lag_s: float | None) -> None:
        """Begin the next slot, which is due."""
        begin_ns = self.next_ns(now_ns, lag_s)
        before = self.slot
        if self._lost(now_ns) or now_ns - begin_ns >= self._length_ns:
            self.slot, self.begin_ns = self._anchored(now_ns, lag_s)
        else:
            shift_s = self.shift_s if lag_s is None else lag_s
            reached = round((begin_ns - self._start_ns - shift_s * 1e9) / self._length_ns)
            self.slot = min(max(self.slot, min(reached, self.slot + 2)), self._slot_count)
            self.begin_ns = begin_ns
        if self.slot < self._slot_count or before < self._slot_count:
            planned_ns = self._start_ns + self.slot * self._length_ns
            self.shift_s = (self.begin_ns - planned_ns) / 1e9

    def _lost(self, now_ns: int) -> bool:
        """Whether there is no slot to go on from: at first, and when the clock was set back."""
        return self.slot < 0 or (now_ns < self.begin_ns and self.begin_ns > self._start_ns)

    def _anchored(self, now_ns: int, lag_s: float | None) -> tuple[int, int]:
        """Slot that the fleet is in now, and when that began."""
        if now_ns < self._start_ns:
            return 0, self._start_ns
        shift_ns = round((self.shift_s if lag_s is None else lag_s) * 1e9)
        reached = (now_ns - self._start_ns - shift_ns) // self._length_ns
        least = 0 if self._lost(now_ns) else self.slot
        slot = min(max(int(reached), least), self._slot_count)
        planned_ns = self._start_ns + slot * self._length_ns + shift_ns
        return slot, min(max(planned_ns, now_ns - self._length_ns, self._start_ns), now_ns)
