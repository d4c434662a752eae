"""`topic hz`."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Callable
from typing import Any

import click

from jfto.ros_cli import graph_names
from jfto.ros_cli.echo import compile_filter
from jfto.ros_cli.session import Session

_PRINT_EVERY_NS = 10**9


class RateMeter:
    """Intervals between the last `window` messages, ns."""

    def __init__(self, window: int) -> None:
        self._intervals: deque[int] = deque(maxlen=window)
        self._last_ns: int | None = None
        self._printed_ns: int | None = None

    def add(self, now_ns: int) -> None:
        """Count a message; a clock that jumped back starts anew."""
        if self._last_ns is not None and now_ns < self._last_ns:
            self._intervals.clear()
        elif self._last_ns is not None:
            self._intervals.append(now_ns - self._last_ns)
        self._last_ns = now_ns

    def report(self) -> str | None:
        """Text of the rate, at most once a second of message time; None where nothing is due."""
        if not self._intervals or self._last_ns is None:
            return None
        if self._printed_ns is None:
            self._printed_ns = self._last_ns
            return None
        if self._last_ns < self._printed_ns + _PRINT_EVERY_NS:
            return None
        self._printed_ns = self._last_ns
        count = len(self._intervals)
        mean = sum(self._intervals) / count
        spread = math.sqrt(sum((each - mean) ** 2 for each in self._intervals) / count)
        rate = 1e9 / mean if mean > 0 else 0.0
        return (
            f"average rate: {rate:.3f}\n\tmin: {min(self._intervals) * 1e-9:.3f}s "
            f"max: {max(self._intervals) * 1e-9:.3f}s std dev: {spread * 1e-9:.5f}s "
            f"window: {count}"
        )


def print_rate(session: Session, topic: str, meter: RateMeter, expression: str | None) -> None:
    """Print the rate of a topic once a second until interrupted."""
    from rclpy.qos import qos_profile_sensor_data

    node = session.node
    passes = compile_filter(expression)
    kind = graph_names.type_of_topic(node, topic)
    while kind is None:
        session.spin_until(_is_known(node, topic))
        kind = graph_names.type_of_topic(node, topic)

    def count(message: Any) -> None:
        if passes(message):
            meter.add(node.get_clock().now().nanoseconds)
            text = meter.report()
            if text is not None:
                click.echo(text)

    node.create_subscription(kind, topic, count, qos_profile_sensor_data, raw=expression is None)
    session.spin_until(lambda: False)


def _is_known(node: Any, topic: str) -> Callable[[], bool]:
    name = graph_names.resolved(node, topic)
    return lambda: name in dict(node.get_topic_names_and_types())
