"""`topic pub`."""

from __future__ import annotations

import time
from typing import Any

import click

from jfto.ros_cli import graph_names
from jfto.ros_cli.errors import RosCommandError
from jfto.ros_cli.interfaces import fill, message_class, read_yaml
from jfto.ros_cli.qos_choice import QosWish, wished_profile
from jfto.ros_cli.session import Session

# Discovery of subscriptions that are already there is quicker than this; it needs no notice.
_SILENT_WAIT_S = 0.5


def publish(
    session: Session,
    topic: str,
    type_name: str,
    values: str,
    wish: QosWish,
    *,
    rate_hz: float,
    times: int,
    print_nth: int,
    wait_for: int,
    keep_alive_s: float,
) -> None:
    """Publish a message `times` times (0: until interrupted).

    Raises RosCommandError where type or values are wrong.
    """
    kind = message_class(type_name)
    plain = read_yaml(values)
    if not isinstance(plain, dict):
        raise RosCommandError("The passed value needs to be a dictionary in YAML format")
    message = kind()
    stamps = fill(message, plain)
    node = session.node
    topic = graph_names.resolved(node, topic)
    publisher = node.create_publisher(kind, topic, wished_profile(wish))
    _wait_for_subscriptions(session, publisher, wait_for)
    click.echo("publisher: beginning loop")
    count = 0
    begin = time.monotonic()
    while True:
        count += 1
        for set_stamp in stamps:
            set_stamp(node.get_clock().now().to_msg())
        if print_nth and count % print_nth == 0:
            click.echo(f"publishing #{count}: {message!r}\n")
        publisher.publish(message)
        if count == times:
            break
        _spin_for(session, begin + count / rate_hz - time.monotonic())
    _spin_for(session, keep_alive_s)
    node.destroy_publisher(publisher)


def _wait_for_subscriptions(session: Session, publisher: Any, count: int) -> None:
    def enough() -> bool:
        return publisher.get_subscription_count() >= count

    pause_s = _SILENT_WAIT_S
    while not session.spin_until(enough, pause_s):
        click.echo(f"Waiting for at least {count} matching subscription(s)...")
        pause_s = 1.0


def _spin_for(session: Session, seconds: float) -> None:
    session.spin_until(lambda: False, max(seconds, 0.0))
