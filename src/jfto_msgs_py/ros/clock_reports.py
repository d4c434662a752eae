"""How far a node has come in simulated time: what a simulation goes by that waits for its graph."""

from __future__ import annotations

from typing import Any

from jfto_msgs_py.ros import qos, topics
from jfto_msgs_py.ros.stamps import encode_time

# Of simulated time, so that a simulation that stands still is not told so over and over.
PERIOD_S = 0.2


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
        node.create_timer(PERIOD_S, self._report)

    def _report(self) -> None:
        now_ns = self._node.get_clock().now().nanoseconds
        if now_ns:
            self._reports.publish(
                self._header(stamp=encode_time(now_ns), frame_id=self._node.get_name())
            )
