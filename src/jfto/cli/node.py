"""jfto node."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING

import click

from jfto.cli.ros_options import graph_command

if TYPE_CHECKING:
    from jfto.ros_cli.session import Session


@click.group("node")
def command() -> None:
    """Nodes of a ROS 2 graph, for computers without ros2cli."""


@command.command("list")
@click.option("-a", "--all", "hidden", is_flag=True, help="Show hidden nodes too.")
@click.option("-c", "--count-nodes", "count_only", is_flag=True, help="Show how many only.")
@graph_command
def list_(session: Session, hidden: bool, count_only: bool) -> None:
    """List the nodes."""
    from jfto.ros_cli import graph

    names = graph.nodes(session.node, hidden=hidden)
    twins = [name for name, count in Counter(names).items() if count > 1]
    if twins:
        click.echo(f"WARNING: several nodes share a name: {', '.join(twins)}.", err=True)
    click.echo(len(names) if count_only else "".join(f"{name}\n" for name in names), nl=count_only)


@command.command("info")
@click.argument("node_name")
@click.option("--include-hidden", "hidden", is_flag=True, help="Show hidden topics too.")
@graph_command
def info(session: Session, node_name: str, hidden: bool) -> None:
    """Show topics and services of NODE_NAME."""
    from jfto.ros_cli import graph

    node = session.node
    full_name = graph.find_node(session, node_name)
    namespace, _, name = full_name.rpartition("/")
    who = name, namespace or "/"
    click.echo(full_name)
    for title, found in (
        ("Subscribers", node.get_subscriber_names_and_types_by_node(*who)),
        ("Publishers", node.get_publisher_names_and_types_by_node(*who)),
        ("Service Servers", node.get_service_names_and_types_by_node(*who)),
        ("Service Clients", node.get_client_names_and_types_by_node(*who)),
    ):
        click.echo(f"  {title}:")
        for entry, kinds in graph.shown(found, hidden=hidden):
            click.echo(f"    {entry}: {', '.join(kinds)}")
