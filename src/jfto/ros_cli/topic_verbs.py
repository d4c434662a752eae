"""`topic echo`, `hz` and `pub`."""

from __future__ import annotations

import contextlib
import statistics
import time
from collections import deque
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import reduce
from itertools import pairwise
from typing import Any

import click
from rclpy.qos import QoSProfile

from jfto.ros_cli import RosCommandError, graph
from jfto.ros_cli.graph import fitting_profile, wished
from jfto.ros_cli.messages import (
    TextLimits,
    fill,
    message_class,
    read_yaml,
    received_ns,
    to_yaml,
)
from jfto.ros_cli.session import Session

_PRINT_EVERY_S = 1.0
# Discovery of subscriptions that are already there is quicker than this; it needs no notice.
_SILENT_WAIT_S = 0.5


@dataclass(frozen=True)
class EchoOptions:
    """What is printed of each message, and until when.

    `field` is the path `a.b` of one field, None for the message; `once` ends after the first
    message, `timeout_s` after so many seconds.
    """

    limits: TextLimits
    field: str | None = None
    once: bool = False
    timeout_s: float | None = None


def echo_topic(
    session: Session, topic: str, type_name: str | None, options: EchoOptions, **qos: Any
) -> None:
    """Print the messages of a topic, or a field of them, until interrupted or done."""
    printed: list[bool] = []

    def show(message: Any) -> None:
        # One message may be taken before the loop sees that the first was printed.
        if not (options.once and printed):
            click.echo(f"{to_yaml(_field(message, options.field), options.limits)}---")
            printed.append(True)

    with _subscribed(session, topic, type_name, show, qos):
        session.spin_until(lambda: options.once and bool(printed), options.timeout_s)


@contextlib.contextmanager
def _subscribed(
    session: Session,
    topic: str,
    type_name: str | None,
    callback: Callable[..., None],
    qos: dict[str, Any],
    **options: Any,
) -> Iterator[None]:
    node = session.node
    if type_name:
        name, types = graph.full_name(node, topic), [type_name]
    else:
        name, types = graph.find_topic(session, topic)
    if len(types) > 1:
        raise RosCommandError(f"Topic {name} has several types: {', '.join(types)}. Name one.")
    profile = wished(fitting_profile(node.get_publishers_info_by_topic(name)), **qos)
    kind = message_class(types[0])
    subscription = node.create_subscription(kind, name, callback, profile, **options)
    try:
        yield
    finally:
        node.destroy_subscription(subscription)


def _field(message: Any, path: str | None) -> Any:
    try:
        return message if path is None else reduce(getattr, path.split("."), message)
    except AttributeError as error:
        raise RosCommandError(f"--field {path}: {error}.") from None


def print_rate(session: Session, topic: str, window: int) -> None:
    """Print the rate of a topic over the last `window` messages, once a second."""
    times_ns: deque[int] = deque(maxlen=window + 1)
    fresh: list[bool] = []

    def count(_data: bytes, info: dict[str, Any]) -> None:
        times_ns.append(received_ns(info))
        fresh.append(True)

    with _subscribed(session, topic, None, count, {}, raw=True):
        while True:
            session.spin_until(lambda: False, _PRINT_EVERY_S)
            if fresh and len(times_ns) > 1:
                click.echo(rate_text(list(times_ns)))
            fresh.clear()


def rate_text(times_ns: list[int]) -> str:
    """The rate of messages by when they came, ns; at least two."""
    intervals = [(b - a) * 1e-9 for a, b in pairwise(times_ns)]
    mean = statistics.fmean(intervals)
    return (
        f"average rate: {1 / mean if mean > 0 else 0:.3f}\n\tmin: {min(intervals):.3f}s "
        f"max: {max(intervals):.3f}s std dev: {statistics.pstdev(intervals):.5f}s "
        f"window: {len(intervals)}"
    )


def publish(
    session: Session,
    *,
    topic: str,
    type_name: str,
    values: str,
    rate_hz: float,
    times: int,
    **qos: Any,
) -> None:
    """Publish a message `times` times (0: until interrupted).

    Where the times are counted it waits for a subscription before. Raises RosCommandError where
    type or values are wrong.
    """
    node, kind, plain = session.node, message_class(type_name), read_yaml(values)

    def message() -> Any:
        made = kind()
        fill(made, plain, node.get_clock().now().to_msg())
        return made

    # What is wrong is told before anybody is waited for.
    message()
    profile = wished(QoSProfile(depth=10), **qos)
    publisher = node.create_publisher(kind, graph.full_name(node, topic), profile)
    wait_s = _SILENT_WAIT_S
    while times and not session.spin_until(publisher.get_subscription_count, wait_s):
        click.echo("Waiting for at least 1 matching subscription(s)...")
        wait_s = 1.0
    begin, count = time.monotonic(), 0
    while not times or count < times:
        count += 1
        sent = message()
        click.echo(f"publishing #{count}: {sent!r}\n")
        publisher.publish(sent)
        # The last one is waited for too: it has to leave before the publisher does.
        wait_s = begin + count / rate_hz - time.monotonic() if count != times else 0.1
        session.pause(max(wait_s, 0.0))
