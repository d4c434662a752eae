"""`param list`, `get`, `set` and `dump`."""

from __future__ import annotations

from typing import Any

import click
import yaml

from jfto.ros_cli import graph_names
from jfto.ros_cli.errors import RosCommandError, last_line
from jfto.ros_cli.service_calls import finish
from jfto.ros_cli.session import Session

_ANSWER_LIMIT_S = 10.0
_KINDS = (
    "not set",
    "boolean",
    "integer",
    "double",
    "string",
    "byte array",
    "boolean array",
    "integer array",
    "double array",
    "string array",
)


def list_parameters(
    session: Session,
    node_name: str | None,
    *,
    hidden: bool,
    prefixes: tuple[str, ...],
    show_types: bool,
    expression: str | None,
) -> None:
    """Print the parameters of a node, or of all. Raises RosCommandError for an unknown node."""
    from rcl_interfaces.srv import DescribeParameters, ListParameters

    known = graph_names.nodes(session.node, hidden=hidden)
    if node_name is not None:
        require_node(session, node_name, hidden=hidden, timeout_s=0.0)
        known = [graph_names.absolute(node_name)]
    offered = dict(graph_names.services(session.node, hidden=True))
    for name in known:
        if f"{name}/list_parameters" not in offered:
            continue
        answer = _call(session, ListParameters, f"{name}/list_parameters", prefixes=list(prefixes))
        names = _matching(sorted(answer.result.names), expression)
        kinds = {}
        if show_types:
            described = _call(
                session, DescribeParameters, f"{name}/describe_parameters", names=names
            )
            kinds = {each.name: f" (type: {_KINDS[each.type]})" for each in described.descriptors}
        if node_name is None:
            click.echo(f"{name}:")
        for each in names:
            click.echo(f"  {each}{kinds.get(each, '')}")


def _matching(names: list[str], expression: str | None) -> list[str]:
    import re

    if expression is None:
        return names
    try:
        pattern = re.compile(expression)
    except re.error as error:
        raise RosCommandError(f"--filter: {error}") from None
    return [name for name in names if pattern.match(name)]


def get_parameter(session: Session, node_name: str, name: str, *, hide_type: bool) -> None:
    """Print a parameter. Raises RosCommandError where it has no value."""
    from rclpy.parameter import parameter_value_to_python

    values = _values(session, node_name, [name])
    if not values:
        raise RosCommandError("Parameter not set")
    value = parameter_value_to_python(values[0])
    kind = _KINDS[values[0].type].removesuffix(" array").capitalize()
    if values[0].type == 0:
        click.echo("Parameter not set.")
    elif hide_type:
        click.echo(value)
    elif isinstance(value, list):
        click.echo(f"{kind} values are: {value}")
    else:
        click.echo(f"{kind} value is: {value}")


def set_parameter(session: Session, node_name: str, name: str, text: str) -> bool:
    """Set a parameter from YAML; whether the node took it, which is said either way."""
    from rcl_interfaces.msg import Parameter
    from rcl_interfaces.srv import SetParameters

    parameter = Parameter(name=name, value=_parse(text))
    service = f"{graph_names.absolute(node_name)}/set_parameters"
    result = _call(session, SetParameters, service, parameters=[parameter]).results[0]
    if result.successful:
        click.echo("Set parameter successful")
    else:
        reason = f": {result.reason}" if result.reason else ""
        click.echo(f"Setting parameter failed{reason}", err=True)
    return bool(result.successful)


def _parse(text: str) -> Any:
    from rclpy.parameter import get_parameter_value

    try:
        plain = yaml.safe_load(text)
    except yaml.YAMLError:
        plain = text
    if plain is not None and not isinstance(plain, (bool, int, float, str, list)):
        raise RosCommandError("TypeError: bad argument type for built-in operation")
    try:
        return get_parameter_value(text)
    except (AssertionError, TypeError, ValueError, OverflowError) as error:
        raise RosCommandError(last_line(error)) from None


def dump_parameters(session: Session, node_name: str) -> None:
    """Print all parameters of a node as a parameter file."""
    from rcl_interfaces.srv import ListParameters
    from rclpy.parameter import PARAMETER_SEPARATOR_STRING, parameter_value_to_python

    full_name = graph_names.absolute(node_name)
    listed = _call(session, ListParameters, f"{full_name}/list_parameters")
    names = sorted(listed.result.names)
    tree: dict[str, Any] = {}
    # Where one parameter has no value the node answers with no values at all.
    for name, value in zip(names, _values(session, node_name, names), strict=False):
        *path, leaf = name.split(PARAMETER_SEPARATOR_STRING)
        branch = tree
        for part in path:
            branch = branch.setdefault(part, {})
        branch[leaf] = parameter_value_to_python(value)
    click.echo(yaml.dump({full_name: {"ros__parameters": tree}}, default_flow_style=False))


def require_node(session: Session, node_name: str, *, hidden: bool, timeout_s: float) -> None:
    """Wait for a node; raises RosCommandError where it does not come."""
    full_name = graph_names.absolute(node_name)
    if not session.spin_until(
        lambda: full_name in graph_names.nodes(session.node, hidden=hidden), timeout_s
    ):
        raise RosCommandError("Node not found")


def _values(session: Session, node_name: str, names: list[str]) -> list[Any]:
    from rcl_interfaces.srv import GetParameters

    service = f"{graph_names.absolute(node_name)}/get_parameters"
    return list(_call(session, GetParameters, service, names=names).values)


def _call(session: Session, kind: Any, service: str, **fields: Any) -> Any:
    client = session.node.create_client(kind, service)
    try:
        if not session.spin_until(client.service_is_ready, _ANSWER_LIMIT_S):
            raise RosCommandError(
                f"Wait for service timed out waiting for parameter services for node "
                f"{service.rpartition('/')[0]}"
            )
        return finish(session, client.call_async(kind.Request(**fields)), _ANSWER_LIMIT_S)
    finally:
        session.node.destroy_client(client)
