"""jfto service."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from jfto.cli.ros_options import graph_command, list_options, print_names

if TYPE_CHECKING:
    from jfto.ros_cli.session import Session

_SILENT_WAIT_S = 0.5


@click.group("service")
def command() -> None:
    """Services of a ROS 2 graph, for computers without ros2cli."""


@command.command("list")
@list_options
@graph_command
def list_(session: Session, hidden: bool, **style: bool) -> None:
    """List the services."""
    from jfto.ros_cli import graph

    print_names(graph.services(session.node, hidden=hidden), **style)


@command.command("call")
@click.argument("name")
@click.argument("type_name", metavar="TYPE")
@click.argument("values", default="{}")
@graph_command
def call(session: Session, name: str, type_name: str, values: str) -> None:
    """Call service NAME of TYPE.

    VALUES is YAML of the request, as in '{data: true}'. Waits for a service that is not there yet.
    """
    from jfto.ros_cli import RosCommandError, graph
    from jfto.ros_cli.messages import fill, read_yaml, service_class

    kind = service_class(type_name)
    request = kind.Request()
    fill(request, read_yaml(values))
    full_name = graph.full_name(session.node, name, is_service=True)
    client = session.node.create_client(kind, full_name)

    def is_ready() -> bool:
        # Our own client is on the list too, with the type that was asked for.
        offered = dict(graph.services(session.node, hidden=True)).get(full_name, [])
        others = [each for each in offered if each != type_name]
        if others and not client.service_is_ready():
            raise RosCommandError(f"{full_name} is of type {', '.join(others)}, not {type_name}.")
        return bool(client.service_is_ready())

    if not session.spin_until(is_ready, _SILENT_WAIT_S):
        click.echo("waiting for service to become available...")
        session.spin_until(is_ready)
    click.echo(f"requester: making request: {request!r}\n")
    future = client.call_async(request)
    session.spin_until(future.done)
    click.echo(f"response:\n{future.result()!r}\n")
