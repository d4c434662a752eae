"""Slots that shift with the fleet: bounded, never back, and never stuck."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from jfto_topology.slot_clock import SlotClock
from support.fleets import START_NS, at

COUNT, SLOT_S = 10, 2.0


def _clock() -> SlotClock:
    return SlotClock(START_NS, COUNT, SLOT_S)


def _run(clock: SlotClock, until_s: float, lag_of, step_s: float = 0.1, from_s: float = 0.0):
    """Advance whenever due; beginnings (s) and numbers of all slots."""
    found = []
    for now_s in np.arange(from_s, until_s, step_s):
        if at(now_s) >= clock.next_ns(at(now_s), lag_of(now_s)):
            clock.advance(at(now_s), lag_of(now_s))
            found.append((round((clock.begin_ns - START_NS) / 1e9, 3), clock.slot))
    return found


def test_on_time_slots_are_the_planned_ones() -> None:
    """Slot n begins at 2 n s; the last one is begun again and again, for the way home."""
    found = _run(_clock(), 24.05, lambda now_s: 0.0)
    assert found == [(2.0 * n, n) for n in range(11)] + [(22.0, 10), (24.0, 10)]


def test_before_the_start_slot_0_is_at_hand() -> None:
    """It begins at time zero, however early it is asked for."""
    clock = _clock()
    clock.advance(at(-50.0), None)
    assert (clock.slot, clock.begin_ns) == (0, START_NS)
    assert clock.next_ns(at(-49.0), None) == at(2.0)


def test_a_small_lag_is_made_up_for_by_longer_slots() -> None:
    """A fleet 1.3 s late: slots of 2.5 s until the shift is 1.3 s, then of 2 s again."""
    found = _run(_clock(), 12.0, lambda now_s: 1.3 if now_s > 1 else 0.0)
    assert found == [(0.0, 0), (2.5, 1), (5.0, 2), (7.3, 3), (9.3, 4), (11.3, 5)]


def test_a_fleet_that_is_held_up_repeats_its_slot() -> None:
    """From 5 s on nobody moves for 20 s: the slot stays, topologies go on, and it goes on after."""
    clock = _clock()
    found = _run(clock, 34.0, lambda now_s: min(max(now_s - 5.0, 0.0), 20.0))
    held = [slot for begin_s, slot in found if 6.0 < begin_s < 25.0]
    assert set(held) <= {2, 3}
    assert len(held) >= 7
    assert clock.shift_s == pytest.approx(20.0, abs=0.6)
    assert clock.slot == 6


def test_a_fleet_that_catches_up_skips_a_slot() -> None:
    """Shifted by 10 s and found on time again, each slot is short or skips one; none goes back."""
    clock = _clock()
    clock.advance(at(14.0), 10.0)
    assert (clock.slot, clock.shift_s) == (2, 10.0)
    slots = [slot for _, slot in _run(clock, 20.05, lambda now_s: 0.0, from_s=14.0)]
    assert slots == [4, 6, 8, 10]
    assert clock.shift_s == pytest.approx(0.0, abs=0.5)


def test_after_a_restart_the_slot_is_found_from_the_lag_at_once() -> None:
    """At 35 s with a lag of 24 s the fleet is in slot 5, which began at 34 s."""
    clock = _clock()
    clock.advance(at(35.0), 24.0)
    assert (clock.slot, clock.begin_ns) == (5, at(34.0))


def test_a_clock_that_jumps_is_followed() -> None:
    """Ahead by five slots: those are passed over. Back by five: anew from there."""
    clock = _clock()
    clock.advance(at(4.0), 0.0)
    clock.advance(at(14.5), 0.0)
    assert (clock.slot, clock.begin_ns) == (7, at(14.0))
    assert clock.next_ns(at(4.5), 0.0) == at(4.0)
    clock.advance(at(4.5), 0.0)
    assert (clock.slot, clock.begin_ns) == (2, at(4.0))


@settings(deadline=None, max_examples=100)
@given(st.lists(st.one_of(st.none(), st.floats(-300, 300)), min_size=5, max_size=60))
def test_whatever_the_lag_a_slot_begins_in_time(lags) -> None:
    """Lags out of the air: slots never go back nor jump, and begin 1.5 to 2.5 s apart."""
    clock = _clock()
    clock.advance(START_NS, 0.0)
    slots, begins, now_ns = [clock.slot], [clock.begin_ns], START_NS
    for lag_s in lags:
        now_ns = max(clock.next_ns(now_ns, lag_s), now_ns)
        clock.advance(now_ns, lag_s)
        slots.append(clock.slot)
        begins.append(clock.begin_ns)
    assert all(0 <= step <= 2 for step in np.diff(slots))
    assert all(1.5 <= step / 1e9 <= 2.5 for step in np.diff(begins))
    assert max(slots) <= COUNT
