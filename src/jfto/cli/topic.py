"""jfto topic."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

import click

from jfto.cli.options import debug_option
from jfto.cli.ros_options import graph_options, session_of
from jfto.ros_cli.qos_choice import (
    DURABILITIES,
    HISTORIES,
    PRESETS,
    RELIABILITIES,
    QosWish,
)

_F = TypeVar("_F", bound=Callable[..., Any])
_POLICIES = {"history": HISTORIES, "reliability": RELIABILITIES, "durability": DURABILITIES}


def _qos_options(preset: str) -> Callable[[_F], _F]:
    def add(function: _F) -> _F:
        for name, values in _POLICIES.items():
            function = click.option(f"--qos-{name}", type=click.Choice(values))(function)
        function = click.option("--qos-depth", type=click.IntRange(min=0), metavar="N")(function)
        return click.option(
            "--qos-profile", type=click.Choice(PRESETS), default=preset, show_default=True
        )(function)

    return add


def _wish(choices: dict[str, Any]) -> QosWish:
    return QosWish(
        preset=choices.pop("qos_profile"),
        depth=choices.pop("qos_depth"),
        history=choices.pop("qos_history"),
        reliability=choices.pop("qos_reliability"),
        durability=choices.pop("qos_durability"),
    )


@click.group("topic")
def command() -> None:
    """Topics of a ROS 2 graph, with or without ROS installed."""


@command.command("list")
@click.option("-t", "--show-types", is_flag=True, help="Show the types too.")
@click.option("-c", "--count-topics", "count_only", is_flag=True, help="Show how many only.")
@click.option("-a", "--all", "--include-hidden-topics", "hidden", is_flag=True)
@click.option("-v", "--verbose", is_flag=True, help="Count publishers and subscribers.")
@graph_options
@debug_option
def list_(spin_time: float, debug: bool, **choices: bool) -> int:  # noqa: ARG001
    """List the topics."""
    from jfto.ros_cli.topic_tables import list_topics

    with session_of(spin_time) as session:
        list_topics(session.node, **choices)
    return 0


@command.command("info")
@click.argument("topic")
@click.option("-v", "--verbose", is_flag=True, help="Show nodes, QoS profiles and type hashes.")
@graph_options
@debug_option
def info(topic: str, verbose: bool, spin_time: float, debug: bool) -> int:  # noqa: ARG001
    """Show the type of TOPIC, who publishes it and who subscribes to it."""
    from jfto.ros_cli.topic_tables import topic_info

    with session_of(spin_time) as session:
        topic_info(session.node, topic, verbose=verbose)
    return 0


@command.command("echo")
@click.argument("topic")
@click.argument("type_name", metavar="[TYPE]", required=False)
@click.option("--csv", is_flag=True, help="One line of values per message.")
@click.option("--field", metavar="NAME", help="Print one field; dots lead into it.")
@click.option("-f", "--full-length", is_flag=True, help="Cut nothing.")
@click.option("-l", "--truncate-length", type=int, default=128, show_default=True)
@click.option("--no-arr", is_flag=True, help="Name arrays instead of printing them.")
@click.option("--no-str", is_flag=True, help="Name strings instead of printing them.")
@click.option("--flow-style", is_flag=True, help="Print arrays in one line.")
@click.option("--no-lost-messages", is_flag=True, help="Do not report lost messages.")
@click.option("--raw", is_flag=True, help="Print the bytes of the message.")
@click.option("--filter", "expression", metavar="EXPR", help="Python expression of the message m.")
@click.option("--once", is_flag=True, help="Print one message and end.")
@click.option("--timeout", type=float, metavar="SECONDS", help="End after so long.")
@click.option("-i", "--include-message-info", "with_info", is_flag=True)
@_qos_options("sensor_data")
@graph_options
@debug_option
def echo(
    topic: str,
    type_name: str | None,
    spin_time: float,
    debug: bool,  # noqa: ARG001
    **choices: Any,
) -> int:
    """Print the messages of TOPIC."""
    from jfto.ros_cli.echo import Echo, EchoStyle, echo_topic
    from jfto.ros_cli.message_text import TextLimits

    wish = _wish(choices)
    length = None if choices["full_length"] else choices["truncate_length"]
    printer = Echo(
        EchoStyle(
            TextLimits(length, choices["no_arr"], choices["no_str"]),
            csv=choices["csv"],
            field=choices["field"],
            flow_style=choices["flow_style"],
            raw=choices["raw"],
            expression=choices["expression"],
            with_info=choices["with_info"],
        )
    )
    with session_of(spin_time) as session:
        echo_topic(
            session,
            topic,
            type_name,
            printer,
            wish,
            once=choices["once"],
            timeout_s=choices["timeout"],
            report_lost=not choices["no_lost_messages"],
        )
    return 0


@command.command("hz")
@click.argument("topic")
@click.option("-w", "--window", type=click.IntRange(min=1), default=10000, show_default=True)
@click.option("--filter", "expression", metavar="EXPR", help="Python expression of the message m.")
@graph_options
@debug_option
def hz(
    topic: str,
    window: int,
    expression: str | None,
    spin_time: float,
    debug: bool,  # noqa: ARG001
) -> int:
    """Print the rate at which messages of TOPIC arrive."""
    from jfto.ros_cli.hz import RateMeter, print_rate

    with session_of(spin_time) as session:
        print_rate(session, topic, RateMeter(window), expression)
    return 0


@command.command("pub")
@click.argument("topic")
@click.argument("type_name", metavar="TYPE")
@click.argument("values", default="{}")
@click.option("-r", "--rate", type=click.FloatRange(min=0, min_open=True), default=1.0)
@click.option("-p", "--print", "print_nth", type=int, default=1, help="Print every Nth only.")
@click.option("-1", "--once", is_flag=True, help="Publish once.")
@click.option("-t", "--times", type=click.IntRange(min=0), default=0, help="Publish so often.")
@click.option("-w", "--wait-matching-subscriptions", "wait_for", type=click.IntRange(min=0))
@click.option("--keep-alive", type=float, default=0.1, metavar="SECONDS", show_default=True)
@click.option("-n", "--node-name", metavar="NAME")
@_qos_options("default")
@graph_options
@debug_option
def pub(
    topic: str,
    type_name: str,
    values: str,
    spin_time: float,
    debug: bool,  # noqa: ARG001
    **choices: Any,
) -> int:
    """Publish VALUES, YAML of a message of TYPE, on TOPIC."""
    from jfto.ros_cli.publish import publish

    if choices["once"] and choices["times"]:
        raise click.UsageError("--once and --times exclude each other.")
    wish = _wish(choices)
    times = 1 if choices["once"] else choices["times"]
    wait_for = choices["wait_for"]
    with session_of(spin_time, choices["node_name"]) as session:
        publish(
            session,
            topic,
            type_name,
            values,
            wish,
            rate_hz=choices["rate"],
            times=times,
            print_nth=choices["print_nth"],
            wait_for=int(times > 0) if wait_for is None else wait_for,
            keep_alive_s=choices["keep_alive"],
        )
    return 0
