"""`service list` and `service call`."""

from __future__ import annotations

import time
from typing import Any

import click

from jfto.ros_cli import graph_names
from jfto.ros_cli.errors import RosCommandError
from jfto.ros_cli.interfaces import fill, read_yaml, service_class
from jfto.ros_cli.session import Session

_SILENT_WAIT_S = 0.5


def list_services(node: Any, *, show_types: bool, count_only: bool, hidden: bool) -> None:
    """Print all services."""
    found = graph_names.services(node, hidden=hidden)
    if count_only:
        click.echo(len(found))
        return
    for name, kinds in found:
        click.echo(f"{name} [{', '.join(kinds)}]" if show_types else name)


def call_service(
    session: Session, name: str, type_name: str, values: str, rate_hz: float | None
) -> None:
    """Call a service and print request and response; again and again if a rate is given.

    Raises RosCommandError where type or values are wrong.
    """
    kind = service_class(type_name)
    request = kind.Request()
    fill(request, read_yaml(values))
    name = graph_names.resolved(session.node, name, is_service=True)
    client = session.node.create_client(kind, name)
    if not session.spin_until(client.service_is_ready, _SILENT_WAIT_S):
        click.echo("waiting for service to become available...")
        session.spin_until(client.service_is_ready)
    while True:
        begin = time.monotonic()
        click.echo(f"requester: making request: {request!r}\n")
        response = finish(session, client.call_async(request), None)
        click.echo(f"response:\n{response!r}\n")
        if rate_hz is None:
            break
        session.spin_until(lambda: False, max(begin + 1 / rate_hz - time.monotonic(), 0.0))
    session.node.destroy_client(client)


def finish(session: Session, future: Any, timeout_s: float | None) -> Any:
    """Response of a call; raises RosCommandError on time-out."""
    if not session.spin_until(future.done, timeout_s):
        future.cancel()
        raise RosCommandError(f"No answer in {timeout_s:g} s. Is the node alive?")
    return future.result()
