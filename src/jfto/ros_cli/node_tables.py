"""`node list` and `node info`."""

from __future__ import annotations

from typing import Any

import click

from jfto.ros_cli import graph_names
from jfto.ros_cli.errors import RosCommandError
from jfto.ros_cli.graph_names import NamesAndTypes

_ACTION = "/_action/send_goal"


def list_nodes(node: Any, *, hidden: bool, count_only: bool) -> None:
    """Print the names of all nodes."""
    names = graph_names.nodes(node, hidden=hidden)
    graph_names.warn_of_twins(names)
    if count_only:
        click.echo(len(names))
    else:
        for name in names:
            click.echo(name)


def node_info(node: Any, full_name: str, *, hidden: bool) -> None:
    """Print what a node offers and uses. Raises RosCommandError if it is not there."""
    count = graph_names.nodes(node, hidden=True).count(full_name)
    if not count:
        raise RosCommandError(f"Unable to find node '{full_name}'")
    if count > 1:
        click.echo(
            f'There are {count} nodes in the graph with the exact name "{full_name}". You are '
            "seeing information about only one of them."
        )
    who = graph_names.split_node_name(full_name)
    servers = node.get_service_names_and_types_by_node(*who)
    clients = node.get_client_names_and_types_by_node(*who)
    click.echo(full_name)
    _section("Subscribers", node.get_subscriber_names_and_types_by_node(*who), hidden)
    _section("Publishers", node.get_publisher_names_and_types_by_node(*who), hidden)
    _section("Service Servers", servers, hidden)
    _section("Service Clients", clients, hidden)
    _section("Action Servers", _actions(servers), hidden)
    click.echo()
    _section("Action Clients", _actions(clients), hidden)


def _section(title: str, entries: NamesAndTypes, hidden: bool) -> None:
    from rclpy.topic_or_service_is_hidden import topic_or_service_is_hidden

    click.echo(f"  {title}:")
    for name, kinds in entries:
        if hidden or not topic_or_service_is_hidden(name):
            click.echo(f"    {name}: {', '.join(kinds)}")


def _actions(services: NamesAndTypes) -> NamesAndTypes:
    return [
        (name.removesuffix(_ACTION), [kind.removesuffix("_SendGoal") for kind in kinds])
        for name, kinds in services
        if name.endswith(_ACTION)
    ]
