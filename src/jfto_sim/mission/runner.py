"""Which mission item is active, and what comes next: ArduPilot's mission library in small.

Navigation items are flown one after another; DO and CONDITION items behind one run while the next
is being flown, each when the one before it is done. Reaching the next navigation item drops those
that have not run.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import Enum
from typing import Protocol

from jfto_sim.dialect import INFO, mavlink
from jfto_sim.mission.items import JUMP, Item, Store
from jfto_sim.ports import Ports

FIRST = 1
_LOOPS_PER_STEP = 8
_SEARCH_MAX = 2000


class RunState(Enum):
    """State of the mission as a whole."""

    STOPPED = "stopped"
    RUNNING = "running"
    COMPLETE = "complete"


class Executor(Protocol):
    """What carries items out: AUTO mode."""

    def start_item(self, seq: int, item: Item) -> None:
        """Begin an item."""

    def item_done(self, seq: int, item: Item) -> bool:
        """Whether an item is finished."""

    def mission_complete(self) -> None:
        """The last item is done."""


@dataclass
class MissionRunner:
    """Index bookkeeping; `nav` and `do` are sequence numbers or None."""

    store: Store
    executor: Executor
    ports: Ports
    state: RunState = RunState.STOPPED
    nav: int | None = None
    nav_loaded: bool = False
    do: int | None = None
    do_loaded: bool = False
    do_all_done: bool = False
    jumped: dict[int, int] = field(default_factory=dict)

    @property
    def count(self) -> int:
        """Items stored, home included."""
        return len(self.store.mission)

    def reset(self) -> None:
        """Forget the position in the mission."""
        self.nav = self.do = None
        self.nav_loaded = self.do_loaded = self.do_all_done = False
        self.jumped.clear()

    def stop(self) -> None:
        """Leave AUTO."""
        if self.state is RunState.RUNNING:
            self.state = RunState.STOPPED

    def start(self) -> None:
        """From the first item."""
        self.state = RunState.RUNNING
        self.reset()
        if not self._advance_nav():
            self._complete()

    def resume(self) -> None:
        """Where it was left; from the first item if it was complete or its item is gone."""
        if self.state is RunState.COMPLETE:
            self.start()
            return
        self.state = RunState.RUNNING
        if self.nav is None or self.nav >= self.count:
            self.start()
        elif self.do_loaded and self.do is not None and self.do < self.nav:
            self.set_current(self.do)
        elif self.nav_loaded:
            self.set_current(self.nav)

    def set_current(self, seq: int) -> bool:
        """Jump to an item; false if there is none."""
        if not 0 <= seq < self.count or self.count <= FIRST:
            return False
        self.do, self.do_loaded, self.do_all_done = None, False, False
        self.nav_loaded = False
        if seq == 0 or self.state is RunState.COMPLETE:
            self.jumped.clear()
            seq = max(seq, FIRST)
        if self.state is not RunState.RUNNING:
            return self._park(seq)
        if not self._advance_nav(seq):
            self._complete()
        return True

    def _park(self, seq: int) -> bool:
        """Note where the mission will begin without starting anything."""
        at = seq
        while not self.nav_loaded:
            found = self._next(at, count_jumps=True)
            if found is None:
                self.nav = None
                return False
            at, item = found
            if item.is_nav:
                self.nav, self.nav_loaded = at, True
            elif not self.do_loaded:
                self.do, self.do_loaded = at, True
            at += 1
        self.state = RunState.STOPPED
        return True

    def restart_nav(self) -> bool:
        """Begin the present item again because the mission was changed under it."""
        if self.nav is None or self.count <= FIRST:
            return False
        return self.set_current(min(self.nav, self.count - 1))

    def update(self) -> None:
        """One step: several of the autopilot's own loops, which run items within milliseconds."""
        for _ in range(_LOOPS_PER_STEP):
            if self.state is not RunState.RUNNING or not self._loop():
                return

    def _loop(self) -> bool:
        """One loop; true if something happened that the next loop may follow up."""
        report: int | None = None
        moved = False
        if not self.nav_loaded:
            moved = True
            if not self._advance_nav():
                self._complete()
                return False
        else:
            assert self.nav is not None
            if self.nav >= self.count:
                self._complete()
                return False
            item = self.store.mission[self.nav]
            if self.executor.item_done(self.nav, item):
                moved, report = True, self.nav if item.reported else None
                self.nav_loaded = False
                if not self._advance_nav():
                    self._flush(report)
                    self._complete()
                    return False
        done = self._loop_do()
        if done is not None:
            moved = True
            report = done if done >= 0 else report
        self._flush(report)
        return moved

    def _flush(self, seq: int | None) -> None:
        if seq is not None:
            self.ports.broadcast(mavlink.MAVLink_mission_item_reached_message(seq))

    def _loop_do(self) -> int | None:
        """Run DO items: None if nothing moved, the seq to report, or -1 if nothing is reported."""
        if not self.do_loaded:
            if self.do_all_done:
                return None
            start = FIRST if self.do is None else self.do + 1
            found = self._next(start, count_jumps=True)
            if found is None or found[1].is_nav:
                self.do_all_done = True
                return None
            self.do, self.do_loaded = found[0], True
            self._begin(*found)
            return -1
        assert self.do is not None
        if self.do >= self.count:
            self.do_loaded = False
            return None
        item = self.store.mission[self.do]
        if not self.executor.item_done(self.do, item):
            return None
        self.do_loaded = False
        return self.do if item.reported else -1

    def _advance_nav(self, start: int | None = None) -> bool:
        if self.state is not RunState.RUNNING or self.nav_loaded:
            return False
        self.do, self.do_loaded, self.do_all_done = None, False, False
        at = start if start is not None else FIRST if self.nav is None else self.nav + 1
        while not self.nav_loaded:
            found = self._next(at, count_jumps=True)
            if found is None:
                return False
            at, item = found
            if item.is_nav:
                self.nav, self.nav_loaded = at, True
                self._begin(at, item)
            elif not self.do_loaded:
                self.do, self.do_loaded = at, True
                self._begin(at, item)
            at += 1
        if not self.do_loaded:
            self.do_all_done = True
        return True

    def _begin(self, seq: int, item: Item) -> None:
        self.ports.text(INFO, f"Mission: {seq} {item.name}")
        self.executor.start_item(seq, item)

    def _complete(self) -> None:
        self.state = RunState.COMPLETE
        self.executor.mission_complete()

    def _next(self, start: int, *, count_jumps: bool) -> tuple[int, Item] | None:
        """The item at or after `start`, jumps followed; None at the end of the mission."""
        at, mission = start, self.store.mission
        taken: dict[int, int] = {}
        for _ in range(_SEARCH_MAX):
            if not 0 <= at < len(mission):
                return None
            item = mission[at]
            if item.command != JUMP:
                return at, item
            target, times = int(item.params[0]), int(item.params[1])
            done = self.jumped.get(at, 0) + taken.get(at, 0)
            if not FIRST <= target < len(mission) or (0 <= times <= done):
                at += 1
                continue
            if count_jumps:
                self.jumped[at] = done + 1
                self.ports.text(INFO, f"Mission: {at} Jump {done + 1}/{times}")
            else:
                taken[at] = taken.get(at, 0) + 1
            at = target
        return None

    def next_nav_after(self, seq: int) -> tuple[int, Item] | None:
        """The next item that is flown, without counting jumps."""
        at = seq + 1
        for _ in range(_SEARCH_MAX):
            found = self._next(at, count_jumps=False)
            if found is None or found[1].is_nav:
                return found
            at = found[0] + 1
        return None
