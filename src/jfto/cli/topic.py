"""jfto topic."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import click

from jfto.cli.ros_options import graph_command, list_options, print_names

if TYPE_CHECKING:
    from jfto.ros_cli.session import Session

_POLICIES = {
    "reliability": ("reliable", "best_effort"),
    "durability": ("transient_local", "volatile"),
}


def _qos_options(function: Callable[..., Any]) -> Callable[..., Any]:
    for name, values in _POLICIES.items():
        kind = click.Choice(values)
        function = click.option(f"--qos-{name}", type=kind, metavar="|".join(values))(function)
    return click.option("--qos-depth", type=click.IntRange(min=1), metavar="N")(function)


@click.group("topic")
def command() -> None:
    """Topics of a ROS 2 graph, for computers without ros2cli."""


@command.command("list")
@list_options
@graph_command
def list_(session: Session, hidden: bool, **style: bool) -> None:
    """List the topics."""
    from jfto.ros_cli import graph

    print_names(graph.topics(session.node, hidden=hidden), **style)


@command.command("info")
@click.argument("topic")
@click.option("-v", "--verbose", is_flag=True, help="Show nodes, QoS profiles and type hashes.")
@graph_command
def info(session: Session, topic: str, verbose: bool) -> None:
    """Show the type and both ends of TOPIC."""
    from jfto.ros_cli import graph

    node = session.node
    name, kinds = graph.find_topic(session, topic)
    click.echo(f"Type: {', '.join(kinds)}")
    for title, endpoints in (
        ("Publisher", node.get_publishers_info_by_topic(name)),
        ("Subscription", node.get_subscriptions_info_by_topic(name)),
    ):
        click.echo(f"{title} count: {len(endpoints)}")
        for endpoint in endpoints if verbose else ():
            click.echo(f"\n{endpoint}\n")


@command.command("echo")
@click.argument("topic")
@click.argument("type_name", metavar="[TYPE]", required=False)
@click.option("--field", metavar="NAME", help="Print one field; dots lead into it.")
@click.option("-f", "--full-length", is_flag=True, help="Cut nothing.")
@click.option(
    "-l",
    "--truncate-length",
    "length",
    type=click.IntRange(0),
    default=128,
    show_default=True,
    metavar="N",
    help="Cut arrays and texts to so many.",
)
@click.option("--no-arr", is_flag=True, help="Name arrays instead of printing them.")
@click.option("--no-str", is_flag=True, help="Name strings instead of printing them.")
@click.option("--once", is_flag=True, help="Print one message and end.")
@click.option("--timeout", "timeout_s", type=float, metavar="SECONDS", help="End after so long.")
@_qos_options
@graph_command
def echo(session: Session, topic: str, type_name: str | None, **choices: Any) -> None:
    """Print the messages of TOPIC.

    Each is a YAML document. The QoS fits the publishers where none is asked for.
    """
    from jfto.ros_cli.messages import TextLimits
    from jfto.ros_cli.topic_verbs import EchoOptions, echo_topic

    qos = {name: value for name, value in choices.items() if name.startswith("qos_")}
    length = None if choices["full_length"] else choices["length"]
    options = EchoOptions(
        field=choices["field"],
        once=choices["once"],
        timeout_s=choices["timeout_s"],
        limits=TextLimits(length, choices["no_arr"], choices["no_str"]),
    )
    echo_topic(session, topic, type_name, options, **qos)


@command.command("hz")
@click.argument("topic")
@click.option(
    "-w",
    "--window",
    type=click.IntRange(min=1),
    default=10000,
    show_default=True,
    metavar="N",
    help="Over the last so many messages.",
)
@graph_command
def hz(session: Session, topic: str, window: int) -> None:
    """Print the rate of TOPIC."""
    from jfto.ros_cli.topic_verbs import print_rate

    print_rate(session, topic, window)


@command.command("pub")
@click.argument("topic")
@click.argument("type_name", metavar="TYPE")
@click.argument("values", default="{}")
@click.option(
    "-r",
    "--rate",
    "rate_hz",
    type=click.FloatRange(0, min_open=True),
    default=1.0,
    show_default=True,
    metavar="HZ",
    help="Publish so often a second.",
)
@click.option("-1", "--once", is_flag=True, help="Publish once.")
@click.option(
    "-t",
    "--times",
    type=click.IntRange(min=0),
    default=0,
    metavar="N",
    help="Publish so often and end.",
)
@_qos_options
@graph_command
def pub(session: Session, once: bool, times: int, **choices: Any) -> None:
    """Publish a message of TYPE on TOPIC.

    VALUES is YAML, as in '{data: 1.5}'. A header may be `auto` and a stamp `now`. With --once or
    --times a subscription is waited for first.
    """
    from jfto.ros_cli.topic_verbs import publish

    if once and times:
        raise click.UsageError("--once and --times exclude each other.")
    publish(session, times=1 if once else times, **choices)
