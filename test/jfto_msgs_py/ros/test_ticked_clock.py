"""A clock that ticks, read between its ticks."""

from __future__ import annotations

import time

import pytest
from rclpy.clock import ROSClock
from rclpy.time import Time

from jfto_msgs_py.ros.clock import AHEAD_MAX_S, TickedClock


def _tick(clock: ROSClock, seconds: float) -> None:
    clock.set_ros_time_override(Time(seconds=seconds, clock_type=clock.clock_type))


@pytest.fixture
def clock() -> ROSClock:
    """A node's clock that follows /clock."""
    found = ROSClock()
    found._set_ros_time_is_active(True)
    return found


def test_it_goes_on_between_ticks_faster_by_the_speed_up(clock) -> None:
    """But never further than a tick may take, and 0 before the first one."""
    ticked = TickedClock(clock, 10.0)
    assert ticked.now_ns() == 0
    begun_s = time.monotonic()
    _tick(clock, 100.0)
    readings = [ticked() for _ in range(100)]
    end_s = time.monotonic() + 10 * AHEAD_MAX_S
    while ticked() < 100.0 + 10 * AHEAD_MAX_S:
        assert time.monotonic() < end_s
    assert readings == sorted(readings)
    assert time.monotonic() - begun_s >= AHEAD_MAX_S
    assert ticked() == 100.0 + 10 * AHEAD_MAX_S
    ticked.close()


def test_it_never_goes_back_when_a_tick_is_behind_what_was_read(clock) -> None:
    """A tick that was late by some milliseconds is no step back in time."""
    ticked = TickedClock(clock, 10.0)
    _tick(clock, 100.0)
    end_s = time.monotonic() + 10.0
    while ticked() < 100.5:
        assert time.monotonic() < end_s
    _tick(clock, 100.2)
    assert ticked() >= 100.5
    _tick(clock, 200.0)
    assert ticked() >= 200.0
    ticked.close()


def test_real_time_is_read_as_it_is() -> None:
    """Where there is no /clock, the speed-up does not matter."""
    ticked = TickedClock(ROSClock(), 10.0)
    before_s = time.time()
    assert before_s <= ticked() <= time.time()
    ticked.close()
