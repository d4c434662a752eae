"""jfto param."""

from __future__ import annotations

from typing import Any

import click

from jfto.cli.options import debug_option
from jfto.cli.ros_options import graph_options, session_of

_hidden_option = click.option("--include-hidden-nodes", "hidden", is_flag=True)
_timeout_option = click.option(
    "--timeout",
    type=float,
    default=1.0,
    show_default=True,
    metavar="SECONDS",
    help="Wait so long for the node.",
)


@click.group("param")
def command() -> None:
    """Parameters of the nodes of a ROS 2 graph, with or without ROS installed."""


@command.command("list")
@click.argument("node_name", required=False)
@_hidden_option
@click.option("--param-prefixes", "prefixes", multiple=True, metavar="PREFIX")
@click.option("--param-type", "show_types", is_flag=True, help="Show the types too.")
@click.option("--filter", "expression", metavar="REGEX", help="Names that begin like this only.")
@graph_options
@debug_option
def list_(node_name: str | None, spin_time: float, debug: bool, **choices: Any) -> int:  # noqa: ARG001
    """List the parameters of NODE_NAME, or of all nodes."""
    from jfto.ros_cli.parameters import list_parameters

    with session_of(spin_time) as session:
        list_parameters(session, node_name, **choices)
    return 0


@command.command("get")
@click.argument("node_name")
@click.argument("name")
@_hidden_option
@click.option("--hide-type", is_flag=True, help="Print the value alone.")
@_timeout_option
@graph_options
@debug_option
def get(
    node_name: str,
    name: str,
    hidden: bool,
    hide_type: bool,
    timeout: float,
    spin_time: float,
    debug: bool,  # noqa: ARG001
) -> int:
    """Print parameter NAME of NODE_NAME."""
    from jfto.ros_cli.parameters import get_parameter, require_node

    with session_of(spin_time) as session:
        require_node(session, node_name, hidden=hidden, timeout_s=timeout)
        get_parameter(session, node_name, name, hide_type=hide_type)
    return 0


@command.command("set")
@click.argument("node_name")
@click.argument("name")
@click.argument("value")
@_hidden_option
@_timeout_option
@graph_options
@debug_option
def set_(
    node_name: str,
    name: str,
    value: str,
    hidden: bool,
    timeout: float,
    spin_time: float,
    debug: bool,  # noqa: ARG001
) -> int:
    """Set parameter NAME of NODE_NAME to VALUE, in YAML.

    Status 1 where the node refuses; ros2cli prints the same text and ends with 0.
    """
    from jfto.ros_cli.parameters import require_node, set_parameter

    with session_of(spin_time) as session:
        require_node(session, node_name, hidden=hidden, timeout_s=timeout)
        return 0 if set_parameter(session, node_name, name, value) else 1


@command.command("dump")
@click.argument("node_name")
@_hidden_option
@_timeout_option
@graph_options
@debug_option
def dump(
    node_name: str,
    hidden: bool,
    timeout: float,
    spin_time: float,
    debug: bool,  # noqa: ARG001
) -> int:
    """Print all parameters of NODE_NAME as a parameter file."""
    from jfto.ros_cli.parameters import dump_parameters, require_node

    with session_of(spin_time) as session:
        require_node(session, node_name, hidden=hidden, timeout_s=timeout)
        dump_parameters(session, node_name)
    return 0
