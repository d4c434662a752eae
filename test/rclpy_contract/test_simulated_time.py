"""Clocks, timers and sleeps on simulated time."""

import threading
import time

import pytest
import rclpy
from rclpy.clock import Clock, ClockType, JumpThreshold
from rclpy.duration import Duration
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.time import Time
from rosgraph_msgs.msg import Clock as ClockMsg

from rclpy_contract.environment import Spinner, spin_for, spin_until, wait_until


class _Simulation:
    """A node ``s`` on simulated time and a second one that publishes ``/clock``."""

    def __init__(self):
        rclpy.init(args=[])
        self.node = Node("s", parameter_overrides=[Parameter("use_sim_time", value=True)])
        self.source = Node("source")
        self.clock = self.node.get_clock()
        self.publisher = self.source.create_publisher(ClockMsg, "/clock", 10)
        self.executor = SingleThreadedExecutor()
        self.executor.add_node(self.node)
        assert wait_until(lambda: self.publisher.get_subscription_count() == 1)

    def set(self, seconds):
        """Publish a time; returns when the node has it and has done what follows."""
        stamp = Time(seconds=seconds).to_msg()
        self.publisher.publish(ClockMsg(clock=stamp))
        arrived = lambda: self.clock.now().nanoseconds == int(seconds * 1e9)  # noqa: E731
        assert spin_until(self.executor, arrived)
        spin_for(self.executor, 0.02)


def test_simulated_time():
    """The recorded story: no clock, first message, steps, jumps, switching off and on."""
    sim = _Simulation()
    assert repr(sim.clock.now()) == "Time(nanoseconds=0, clock_type=ROS_TIME)"
    assert sim.clock.ros_time_is_active is True
    assert [s.topic_name for s in sim.node.subscriptions] == ["/clock"]
    info = sim.source.get_subscriptions_info_by_topic("/clock")[0].qos_profile
    shown = (info.reliability.name, info.durability.name, info.history.name, info.depth)
    assert shown == ("BEST_EFFORT", "VOLATILE", "KEEP_LAST", 1)
    ticks, jumps = [], []
    sim.node.create_timer(1.0, lambda: ticks.append(sim.clock.now().nanoseconds / 1e9))
    threshold = JumpThreshold(
        min_forward=Duration(seconds=5), min_backward=Duration(seconds=-1), on_clock_change=True
    )
    handle = sim.clock.create_jump_callback(
        threshold,
        pre_callback=lambda: jumps.append("pre"),
        post_callback=lambda jump: jumps.append(
            ("post", jump.clock_change.name.rpartition("RCL_")[2], jump.delta.nanoseconds / 1e9)
        ),
    )
    spin_for(sim.executor, 0.1)
    assert ticks == []
    sim.set(100)
    assert (ticks, jumps) == ([100.0], ["pre", ("post", "ROS_TIME_NO_CHANGE", 100.0)])
    for seconds, expected in (
        (100.5, [100.0]),
        (101.0, [100.0, 101.0]),
        (101.5, [100.0, 101.0]),
        (110, [100.0, 101.0, 110.0]),
        (110.2, [100.0, 101.0, 110.0]),
        (111, [100.0, 101.0, 110.0, 111.0]),
    ):
        sim.set(seconds)
        assert ticks == expected, seconds
    assert jumps[-1] == ("post", "ROS_TIME_NO_CHANGE", 8.5)
    sim.set(50)
    assert jumps[-1] == ("post", "ROS_TIME_NO_CHANGE", -61.0)
    ticks.clear()
    for seconds, expected in (
        (50.5, []),
        (51, [51.0]),
        (52, [51.0, 52.0]),
        (53, [51.0, 52.0, 53.0]),
    ):
        sim.set(seconds)
        assert ticks == expected, seconds
    assert sim.node.set_parameters([Parameter("use_sim_time", value=False)])[0].successful
    assert sim.clock.ros_time_is_active is False
    assert abs(sim.clock.now().nanoseconds / 1e9 - time.time()) < 5.0
    assert jumps[-1] == ("post", "ROS_TIME_DEACTIVATED", 0.0)
    ticks.clear()
    assert spin_until(sim.executor, lambda: len(ticks) >= 2)
    assert sim.node.set_parameters([Parameter("use_sim_time", value=True)])[0].successful
    assert repr(sim.clock.now()) == "Time(nanoseconds=53000000000, clock_type=ROS_TIME)"
    assert jumps[-1] == ("post", "ROS_TIME_ACTIVATED", 0.0)
    sim.set(60)
    assert [s.topic_name for s in sim.node.subscriptions] == ["/clock"]
    handle.unregister()


def test_sleep_on_simulated_time():
    """``sleep_for`` ends when simulated time says so, not wall time."""
    sim = _Simulation()
    sim.set(60)
    results = []

    def sleep():
        results.append((sim.clock.sleep_for(Duration(seconds=2)), sim.clock.now().nanoseconds))

    thread = threading.Thread(target=sleep)
    thread.start()
    # The sleeper registers for jumps before it looks at the clock.
    spin_for(sim.executor, 0.3)
    with Spinner(sim.executor):
        sim.publisher.publish(ClockMsg(clock=Time(seconds=61.9).to_msg()))
        assert wait_until(lambda: sim.clock.now().nanoseconds == 61_900_000_000)
        assert results == []
        sim.publisher.publish(ClockMsg(clock=Time(seconds=62).to_msg()))
        assert wait_until(lambda: results)
    thread.join()
    assert results == [(True, 62_000_000_000)]


def test_jump_thresholds():
    """Thresholds have a sign, one must be set, and a callback is needed."""
    with pytest.raises(ValueError, match="min_forward must be a positive non-zero duration"):
        JumpThreshold(min_forward=Duration(seconds=-1), min_backward=None)
    with pytest.raises(ValueError, match="min_backward must be a negative non-zero duration"):
        JumpThreshold(min_forward=None, min_backward=Duration(seconds=1))
    with pytest.raises(ValueError, match="At least one jump threshold must be enabled"):
        JumpThreshold(min_forward=None, min_backward=None, on_clock_change=False)
    threshold = JumpThreshold(min_forward=Duration(seconds=1), min_backward=None)
    with pytest.raises(ValueError, match="One of pre_callback or post_callback"):
        Clock(clock_type=ClockType.STEADY_TIME).create_jump_callback(threshold)


def test_clocks_have_no_timers():
    """Timers come from nodes, on any clock."""
    rclpy.init(args=[])
    assert not hasattr(Clock(), "create_timer")
    timer = Node("n").create_timer(1, lambda: None, clock=Clock())
    assert timer.clock.clock_type == ClockType.SYSTEM_TIME
