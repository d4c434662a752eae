"""A node's time: read finely between ticks of /clock, and told to whoever waits for the node."""

from __future__ import annotations

import time
from typing import Any

from jfto_msgs_py.ros import qos, topics
from jfto_msgs_py.ros.stamps import encode_time

# A clock whose ticks stop, as that of a simulation does which waits for its graph, is not carried
# on for longer than this, in wall seconds: ticks come every 0.02 s.
AHEAD_MAX_S = 0.05
NS = 1_000_000_000
# Of simulated time between reports: one that stands still is not told so over and over.
REPORT_PERIOD_S = 0.2


class TickedClock:
    """A node's clock in seconds; between ticks of simulated time it goes on at `speedup`.

    It never goes back. May be read in any thread; call `close` before the node goes.
    """

    def __init__(self, clock: Any, speedup: float) -> None:
        from rclpy.clock import JumpThreshold
        from rclpy.duration import Duration

        self._clock, self.speedup = clock, speedup
        self._tick = (self._now_ns(), time.monotonic())
        self._last_ns = 0
        every = JumpThreshold(
            min_forward=Duration(nanoseconds=1), min_backward=None, on_clock_change=True
        )
        self._jumps = clock.create_jump_callback(every, post_callback=self._on_jump)

    def now_ns(self) -> int:
        """Time, ns since the epoch; 0 until simulated time has come."""
        if not self._clock.ros_time_is_active:
            return self._now_ns()
        tick_ns, at_s = self._tick
        if tick_ns == 0:
            return 0
        ahead_s = min(time.monotonic() - at_s, AHEAD_MAX_S) * self.speedup
        self._last_ns = max(self._last_ns, tick_ns + round(ahead_s * NS))
        return self._last_ns

    def __call__(self) -> float:
        """Time in seconds since the epoch."""
        return self.now_ns() / NS

    def close(self) -> None:
        """Listen to no more ticks."""
        self._jumps.unregister()

    def _now_ns(self) -> int:
        return int(self._clock.now().nanoseconds)

    def _on_jump(self, _jump: Any) -> None:
        self._tick = (self._now_ns(), time.monotonic())


class ClockReports:
    """Reports of a node that takes its time from /clock; silent where it does not.

    They come from the node's executor, where its callbacks run too: whoever has reported a time has
    done with what reached it before, or is about to.
    """

    def __init__(self, node: Any) -> None:
        from std_msgs.msg import Header

        self._node, self._header = node, Header
        if not node.get_parameter("use_sim_time").value:
            return
        self._reports = node.create_publisher(Header, topics.CLOCK_TAKEN, qos.reports())
        node.create_timer(REPORT_PERIOD_S, self._report)

    def _report(self) -> None:
        now_ns = self._node.get_clock().now().nanoseconds
        if now_ns:
            self._reports.publish(
                self._header(stamp=encode_time(now_ns), frame_id=self._node.get_name())
            )
