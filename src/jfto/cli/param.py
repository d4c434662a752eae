"""jfto param."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from jfto.cli.ros_options import graph_command

if TYPE_CHECKING:
    from jfto.ros_cli.session import Session


@click.group("param")
def command() -> None:
    """Parameters of the nodes of a ROS 2 graph, for computers without ros2cli."""


@command.command("list")
@click.argument("node_name", required=False)
@click.option("--param-type", "show_types", is_flag=True, help="Show the types too.")
@graph_command
def list_(session: Session, node_name: str | None, show_types: bool) -> None:
    """List those of NODE_NAME, or of all nodes."""
    from jfto.ros_cli import graph
    from jfto.ros_cli.parameters import list_types, wait_for

    node = session.node
    if node_name is not None:
        names = [graph.find_node(session, node_name)]
    else:
        offered = dict(graph.services(node, hidden=True))
        names = [each for each in graph.nodes(node) if f"{each}/list_parameters" in offered]
    for name in names:
        if node_name is None:
            click.echo(f"{name}:")
        for each, kind in wait_for(session, name, list_types(node, name)).items():
            word = kind.name.lower().replace("_", " ")
            click.echo(f"  {each} (type: {word})" if show_types else f"  {each}")


@command.command("get")
@click.argument("node_name")
@click.argument("name")
@click.option("--hide-type", is_flag=True, help="Print the value alone.")
@graph_command
def get(session: Session, node_name: str, name: str, hide_type: bool) -> None:
    """Print parameter NAME of NODE_NAME."""
    from jfto.ros_cli import RosCommandError, graph
    from jfto.ros_cli.parameters import get_values, wait_for

    owner = graph.find_node(session, node_name)
    values = wait_for(session, owner, get_values(session.node, owner, [name]))
    if not values:
        raise RosCommandError(f"{owner} has no parameter {name}, or it has no value.")
    (value,) = values
    words = {bool: "Boolean", int: "Integer", float: "Double", str: "String"}
    several = isinstance(value, list)
    kind = words.get(type(value[0] if several and value else value), "Array")
    head = f"{kind} values are: " if several else f"{kind} value is: "
    click.echo(f"{'' if hide_type else head}{value}")


@command.command("set")
@click.argument("node_name")
@click.argument("name")
@click.argument("value")
@graph_command
def set_(session: Session, node_name: str, name: str, value: str) -> int:
    """Set parameter NAME of NODE_NAME.

    VALUE is YAML; what is neither a number, a truth nor a list is a text. Status 1 where the node
    refuses; ros2cli ends with 0.
    """
    from jfto.ros_cli import graph
    from jfto.ros_cli.parameters import set_value, wait_for

    owner = graph.find_node(session, node_name)
    refusal = wait_for(session, owner, set_value(session.node, owner, name, value))
    if refusal is not None:
        click.echo(f"Setting parameter failed: {refusal}", err=True)
        return 1
    click.echo("Set parameter successful")
    return 0


@command.command("dump")
@click.argument("node_name")
@graph_command
def dump(session: Session, node_name: str) -> None:
    """Print NODE_NAME's as a parameter file.

    Those without a value are left out.
    """
    import yaml

    from jfto.ros_cli import graph
    from jfto.ros_cli.parameters import read_all, wait_for

    owner = graph.find_node(session, node_name)
    values = wait_for(session, owner, read_all(session.node, owner))
    click.echo(yaml.safe_dump({owner: {"ros__parameters": values}}), nl=False)
