"""`topic list` and `topic info`."""

from __future__ import annotations

from typing import Any

import click

from jfto.ros_cli import graph_names
from jfto.ros_cli.errors import RosCommandError


def list_topics(
    node: Any, *, show_types: bool, count_only: bool, hidden: bool, verbose: bool
) -> None:
    """Print all topics."""
    found = graph_names.topics(node, hidden=hidden)
    if count_only:
        click.echo(len(found))
    elif verbose and found:
        counts = [(name, kinds, node.count_publishers(name)) for name, kinds in found]
        click.echo(_counted("Published", "publisher", counts))
        counts = [(name, kinds, node.count_subscribers(name)) for name, kinds in found]
        click.echo(_counted("Subscribed", "subscriber", counts))
    else:
        for name, kinds in found:
            click.echo(f"{name} [{', '.join(kinds)}]" if show_types else name)


def _counted(title: str, what: str, counts: list[tuple[str, list[str], int]]) -> str:
    lines = [
        f" * {name} [{', '.join(kinds)}] {count} {what}{'s' if count > 1 else ''}\n"
        for name, kinds, count in counts
        if count
    ]
    return f"{title} topics:\n{''.join(lines)}"


def topic_info(node: Any, topic: str, *, verbose: bool) -> None:
    """Print type, publishers and subscriptions of a topic. Raises RosCommandError if unknown."""
    kinds = dict(graph_names.topics(node, hidden=True)).get(topic)
    if kinds is None:
        raise RosCommandError(f"Unknown topic '{topic}'")
    gap = "\n\n" if verbose else "\n"
    click.echo(f"Type: {kinds[0] if len(kinds) == 1 else kinds}{gap}", nl=False)
    click.echo(f"Publisher count: {node.count_publishers(topic)}{gap}", nl=False)
    if verbose:
        for endpoint in node.get_publishers_info_by_topic(topic):
            click.echo(f"{endpoint}{gap}", nl=False)
    click.echo(f"Subscription count: {node.count_subscribers(topic)}{gap}", nl=False)
    if verbose:
        for endpoint in node.get_subscriptions_info_by_topic(topic):
            click.echo(f"{endpoint}{gap}", nl=False)
