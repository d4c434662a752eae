"""`topic echo`."""

from __future__ import annotations

import operator
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import click
import yaml

from jfto.ros_cli import graph_names
from jfto.ros_cli.errors import RosCommandError, last_line
from jfto.ros_cli.interfaces import message_class
from jfto.ros_cli.message_text import TextLimits, to_csv, to_yaml
from jfto.ros_cli.qos_choice import QosWish, subscription_profile
from jfto.ros_cli.session import Session


@dataclass(frozen=True)
class EchoStyle:
    """How messages are chosen and printed."""

    limits: TextLimits
    csv: bool = False
    field: str | None = None
    flow_style: bool = False
    raw: bool = False
    expression: str | None = None
    with_info: bool = False


class Echo:
    """Prints messages; `printed` counts them."""

    def __init__(self, style: EchoStyle) -> None:
        self.style = style
        self.printed = 0
        self._passes = compile_filter(style.expression)

    def show(self, message: Any, info: Any) -> None:
        """Print one message, or its field. Raises RosCommandError for a field it lacks."""
        style = self.style
        value = message if style.field is None else _field(message, style.field)
        if not self._passes(value):
            return
        self.printed += 1
        if not hasattr(value, "get_fields_and_field_types"):
            self._head(info)
            click.echo(f"{value}\n---")
        elif style.csv:
            line = to_csv(value, style.limits)
            if style.with_info:
                line = ",".join(str(item) for item in _plain_info(info).values()) + "," + line
            click.echo(line)
        else:
            self._head(info)
            text = to_yaml(value, style.limits, flow_style=style.flow_style)
            click.echo(f"{text}---")

    def _head(self, info: Any) -> None:
        if self.style.with_info:
            click.echo(f"{yaml.dump(_plain_info(info))}---")


def _plain_info(info: Any) -> dict[str, Any]:
    keys = (
        "source_timestamp",
        "received_timestamp",
        "publication_sequence_number",
        "reception_sequence_number",
    )
    return {key: info.get(key) for key in keys}


def _field(message: Any, path: str) -> Any:
    value = message
    for name in path.split("."):
        try:
            value = operator.attrgetter(name)(value)
        except AttributeError as error:
            raise RosCommandError(f"Invalid field '{path}': {error}") from None
    return value


def compile_filter(expression: str | None) -> Callable[[Any], bool]:
    """Turn a Python expression of the message `m` into a test; raises RosCommandError."""
    if expression is None:
        return lambda _message: True
    try:
        code = compile(expression, "--filter", "eval")
    except SyntaxError as error:
        raise RosCommandError(f"SyntaxError: {error.msg}") from None

    def passes(message: Any) -> bool:
        try:
            # The expression is the user's own, as in ros2cli.
            return bool(eval(code, {"m": message}))  # noqa: S307
        except Exception as error:  # noqa: BLE001 - whatever the user's expression raises
            raise RosCommandError(last_line(error)) from None

    return passes


def echo_topic(
    session: Session,
    topic: str,
    type_name: str | None,
    echo: Echo,
    wish: QosWish,
    *,
    once: bool,
    timeout_s: float | None,
    report_lost: bool,
) -> None:
    """Print the messages of a topic until interrupted, timed out, or once."""
    from rclpy.event_handler import SubscriptionEventCallbacks

    node = session.node
    topic = graph_names.resolved(node, topic) if type_name else topic
    if type_name is None:
        kind = graph_names.type_of_topic(node, topic)
        if kind is None:
            raise RosCommandError("Could not determine the type for the passed topic")
    else:
        kind = message_class(type_name)
    events = SubscriptionEventCallbacks(message_lost=_say_lost if report_lost else None)
    subscription = node.create_subscription(
        kind,
        topic,
        # One message may be taken before the loop sees that the first was printed.
        lambda message, info: None if once and echo.printed else echo.show(message, info),
        subscription_profile(node, topic, wish),
        event_callbacks=events,
        raw=echo.style.raw,
    )
    try:
        session.spin_until(lambda: once and echo.printed > 0, timeout_s)
    finally:
        node.destroy_subscription(subscription)


def _say_lost(event: Any) -> None:
    click.echo(
        f"A message was lost!!!\n\ttotal count change:{event.total_count_change}"
        f"\n\ttotal count: {event.total_count}\n---"
    )
