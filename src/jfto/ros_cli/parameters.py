"""Parameters of other nodes, by the services that every node offers.

What takes several calls is a generator of conditions to wait for, so that a command can wait for
each while the recorder goes on recording.
"""

from __future__ import annotations

from collections.abc import Callable, Generator
from typing import Any, TypeVar

import yaml
from rcl_interfaces.msg import Parameter as ParameterMessage
from rcl_interfaces.srv import GetParameters, GetParameterTypes, ListParameters, SetParameters
from rclpy.parameter import Parameter, parameter_value_to_python

from jfto.ros_cli import RosCommandError
from jfto.ros_cli.messages import fill
from jfto.ros_cli.session import Session

Result = TypeVar("Result")
Steps = Generator[Callable[[], bool], None, Result]
_ANSWER_LIMIT_S = 10.0
# In the order of rcl_interfaces/msg/ParameterType, which has lists of each five numbers further.
_KINDS = {bool: "bool", int: "integer", float: "double", str: "string"}


def call(node: Any, kind: Any, service: str, request: Any) -> Steps[Any]:
    """Call a service once it is there; its response."""
    client = node.create_client(kind, service)
    try:
        yield client.service_is_ready
        future = client.call_async(request)
        yield future.done
        return future.result()
    finally:
        node.destroy_client(client)


def wait_for(session: Session, what: str, steps: Steps[Result]) -> Result:
    """Spin through all steps; raises RosCommandError naming `what` where one takes too long."""
    try:
        while session.spin_until(next(steps), _ANSWER_LIMIT_S):
            pass
    except StopIteration as end:
        return end.value
    raise RosCommandError(f"{what} gives no answer in {_ANSWER_LIMIT_S:g} s. Is it alive?")


def list_types(node: Any, owner: str) -> Steps[dict[str, Parameter.Type]]:
    """Names of a node's parameters, sorted, and of what type each is."""
    request = ListParameters.Request()
    listed = yield from call(node, ListParameters, f"{owner}/list_parameters", request)
    names = sorted(listed.result.names)
    types = yield from call(
        node,
        GetParameterTypes,
        f"{owner}/get_parameter_types",
        GetParameterTypes.Request(names=names),
    )
    return {name: Parameter.Type(kind) for name, kind in zip(names, types.types, strict=False)}


def get_values(node: Any, owner: str, names: list[str]) -> Steps[list[Any]]:
    """Values of a node's parameters as plain data; none at all where one of them has none."""
    request = GetParameters.Request(names=names)
    response = yield from call(node, GetParameters, f"{owner}/get_parameters", request)
    return [parameter_value_to_python(value) for value in response.values]


def read_all(node: Any, owner: str) -> Steps[dict[str, Any]]:
    """All parameters of a node that have a value, by name, as plain data."""
    types = yield from list_types(node, owner)
    chosen = [name for name, kind in types.items() if kind != Parameter.Type.NOT_SET]
    values = yield from get_values(node, owner, chosen)
    return dict(zip(chosen, values, strict=False))


def set_value(node: Any, owner: str, name: str, text: str) -> Steps[str | None]:
    """Set a parameter from YAML; None, or why the node refuses.

    What is neither a number, a truth nor a list of one kind is a text, as in ros2cli.
    """
    request = SetParameters.Request(parameters=[_parameter(name, text)])
    response = yield from call(node, SetParameters, f"{owner}/set_parameters", request)
    (result,) = response.results
    return None if result.successful else result.reason or "the node gives no reason"


def _parameter(name: str, text: str) -> Any:
    # get_parameter_value of rclpy fails on a date, a map or an open quote, which are texts here.
    try:
        plain = yaml.safe_load(text)
    except yaml.YAMLError:
        plain = text
    value: dict[str, Any] = {"type": 4, "string_value": text}
    for number, (kind, word) in enumerate(_KINDS.items(), start=1):
        if type(plain) is kind:
            value = {"type": number, f"{word}_value": plain}
        elif isinstance(plain, list) and plain and all(type(each) is kind for each in plain):
            value = {"type": number + 5, f"{word}_array_value": plain}
    parameter = ParameterMessage()
    fill(parameter, {"name": name, "value": value})
    return parameter
