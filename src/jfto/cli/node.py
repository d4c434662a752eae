"""jfto node."""

from __future__ import annotations

import click

from jfto.cli.options import debug_option
from jfto.cli.ros_options import graph_options, session_of


@click.group("node")
def command() -> None:
    """Nodes of a ROS 2 graph, with or without ROS installed."""


@command.command("list")
@click.option("-a", "--all", "hidden", is_flag=True, help="Show hidden nodes too.")
@click.option("-c", "--count-nodes", "count_only", is_flag=True, help="Show how many only.")
@graph_options
@debug_option
def list_(hidden: bool, count_only: bool, spin_time: float, debug: bool) -> int:  # noqa: ARG001
    """List the nodes."""
    from jfto.ros_cli.node_tables import list_nodes

    with session_of(spin_time) as session:
        list_nodes(session.node, hidden=hidden, count_only=count_only)
    return 0


@command.command("info")
@click.argument("node_name")
@click.option("--include-hidden", "hidden", is_flag=True, help="Show hidden topics too.")
@graph_options
@debug_option
def info(node_name: str, hidden: bool, spin_time: float, debug: bool) -> int:  # noqa: ARG001
    """Show what NODE_NAME, with its leading slash, publishes, subscribes to, serves and calls."""
    from jfto.ros_cli.node_tables import node_info

    with session_of(spin_time) as session:
        node_info(session.node, node_name, hidden=hidden)
    return 0
