"""Timers and rates on wall time: order, counts and limits, no exact moments."""

import itertools
import threading
import time

import pytest
import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node

from rclpy_contract.environment import Spinner, spin_for, spin_until, wait_until


def _node():
    rclpy.init(args=[])
    node, executor = Node("n"), SingleThreadedExecutor()
    executor.add_node(node)
    return node, executor


def test_timer_ticks():
    """A timer first fires after one period, then no sooner than its schedule."""
    node, executor = _node()
    ticks, start = [], time.monotonic()
    node.create_timer(0.05, lambda: ticks.append(time.monotonic() - start))
    assert spin_until(executor, lambda: len(ticks) >= 4)
    assert all(tick >= 0.05 * (number + 1) - 0.002 for number, tick in enumerate(ticks))


def test_overrunning_timer_does_not_catch_up():
    """A callback longer than the period runs again at once, and lost ticks stay lost."""
    node, executor = _node()
    starts, pause = [], threading.Event()

    def slow():
        starts.append(time.monotonic())
        pause.wait(0.125)

    begin = time.monotonic()
    node.create_timer(0.05, slow)
    assert spin_until(executor, lambda: len(starts) >= 4)
    gaps = [later - earlier for earlier, later in itertools.pairwise(starts)]
    assert min(gaps) >= 0.124
    assert len(starts) < (time.monotonic() - begin) / 0.05


def test_timer_of_period_zero():
    """A timer without a period fires whenever it can."""
    node, executor = _node()
    ticks = []
    node.create_timer(0, lambda: ticks.append(1))
    assert spin_until(executor, lambda: len(ticks) >= 20)


def test_timer_interface():
    """State of a timer: fresh, cancelled, reset."""
    node, executor = _node()
    ticks = []
    timer = node.create_timer(0.1, lambda: ticks.append(1))
    assert timer.is_canceled() is False
    assert timer.timer_period_ns == 100_000_000
    assert timer.time_until_next_call() <= 100_000_000
    assert timer.time_since_last_call() >= 0
    assert spin_until(executor, lambda: len(ticks) >= 2)
    timer.cancel()
    assert (timer.is_canceled(), timer.time_until_next_call()) == (True, None)
    count = len(ticks)
    spin_for(executor, 0.25)
    assert len(ticks) == count
    timer.reset()
    assert timer.is_canceled() is False
    assert timer.time_until_next_call() > 0
    assert spin_until(executor, lambda: len(ticks) > count)


def test_reset_and_new_period():
    """``reset`` counts a period from now; a new period holds from the next call on."""
    node, executor = _node()
    ticks = []
    timer = node.create_timer(0.2, lambda: ticks.append(time.monotonic()))
    spin_for(executor, 0.05)
    timer.reset()
    reset = time.monotonic()
    assert spin_until(executor, lambda: ticks)
    assert ticks[0] - reset >= 0.198
    timer.timer_period_ns = 20_000_000
    left_s = timer.time_until_next_call() / 1e9
    assert left_s > 0.02 or len(ticks) > 1
    assert spin_until(executor, lambda: len(ticks) >= 4)
    assert timer.timer_period_ns == 20_000_000


def test_missed_ticks_are_not_made_up():
    """A timer that nobody spun for several periods fires once."""
    node, executor = _node()
    ticks = []
    timer = node.create_timer(0.5, lambda: ticks.append(1))
    assert wait_until(lambda: timer.time_until_next_call() < -1_100_000_000)
    executor.spin_once(timeout_sec=1.0)
    executor.spin_once(timeout_sec=0.0)
    assert len(ticks) == 1


def test_timer_without_autostart():
    """A timer that is not started does not fire."""
    node, executor = _node()
    ticks = []
    timer = node.create_timer(0.01, lambda: ticks.append(1), autostart=False)
    spin_for(executor, 0.1)
    assert (timer.is_canceled(), ticks) == (True, [])


def test_timer_callback_with_argument():
    """A timer callback gets no argument."""
    node, executor = _node()
    node.create_timer(0.01, lambda info: info)
    with pytest.raises(TypeError, match="missing 1 required positional argument: 'info'"):
        executor.spin_once(timeout_sec=5.0)


def test_rate_sleeps_periods():
    """``sleep`` returns once per period while another thread spins."""
    node, executor = _node()
    rate = node.create_rate(20)
    with Spinner(executor):
        start = time.monotonic()
        for _ in range(4):
            rate.sleep()
        assert time.monotonic() - start >= 0.148
        node.destroy_rate(rate)


def test_rate_remembers_one_tick():
    """A tick that nobody slept for ends the next sleep at once, but only that one."""
    node, executor = _node()
    rate = node.create_rate(4)
    with Spinner(executor):
        rate.sleep()
        fired = threading.Event()
        node.create_timer(0.6, fired.set)
        assert fired.wait(20.0)
        start = time.monotonic()
        rate.sleep()
        rate.sleep()
        assert time.monotonic() - start < 0.45
        node.destroy_rate(rate)


def test_destroyed_rate():
    """A destroyed rate does not sleep."""
    node, _ = _node()
    rate = node.create_rate(5)
    assert rate.destroy() is None
    with pytest.raises(RuntimeError, match="Rate cannot sleep because it has been destroyed"):
        rate.sleep()
    assert node.destroy_rate(node.create_rate(5)) is True


@pytest.mark.parametrize("frequency", [0, -1])
def test_illegal_rates(frequency):
    """A frequency is positive."""
    node, _ = _node()
    with pytest.raises(ValueError, match="frequency must be > 0"):
        node.create_rate(frequency)


def test_rate_of_unspun_node_blocks_until_destroyed():
    """Without anybody spinning, only destruction ends a sleep."""
    node, _ = _node()
    rate, ended = node.create_rate(50), threading.Event()

    def sleep():
        rate.sleep()
        ended.set()

    thread = threading.Thread(target=sleep)
    thread.start()
    assert not ended.wait(0.3)
    node.destroy_rate(rate)
    assert ended.wait(20.0)
    thread.join()
