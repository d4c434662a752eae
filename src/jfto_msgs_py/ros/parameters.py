"""Scenario keys and a node's own options as ROS parameters: declared, read, validated at set."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import Any, Generic, TypeVar

from rcl_interfaces.msg import (
    FloatingPointRange,
    IntegerRange,
    ParameterDescriptor,
    SetParametersResult,
)
from rclpy.parameter import Parameter

from jfto_msgs_py.errors import JftoError, ScenarioError
from jfto_msgs_py.scenario import KEYS, Given, Key, Scenario
from jfto_msgs_py.scenario.options import is_of_ros, option_keys, resolve
from jfto_msgs_py.scenario.scenario import RADIO_SHORTHANDS

Options = TypeVar("Options")

_TYPES = {
    ("bool", False): Parameter.Type.BOOL,
    ("bool", True): Parameter.Type.BOOL_ARRAY,
    ("int", False): Parameter.Type.INTEGER,
    ("int", True): Parameter.Type.INTEGER_ARRAY,
    ("float", False): Parameter.Type.DOUBLE,
    ("float", True): Parameter.Type.DOUBLE_ARRAY,
    ("text", False): Parameter.Type.STRING,
    ("text", True): Parameter.Type.STRING_ARRAY,
}


class NodeParameters(Generic[Options]):
    """All parameters of one node: every scenario key and the node's own options.

    The node must have been made with `automatically_declare_parameters_from_overrides`, so that
    unknown names show. Raises ScenarioError that lists every problem. While `is_active()` nothing
    may be set; `check` may refuse a scenario and options by raising JftoError.
    """

    def __init__(
        self,
        node: Any,
        options_type: type[Options],
        is_active: Callable[[], bool],
        check: Callable[[Scenario, Options], None],
    ) -> None:
        self._node = node
        self._options_type = options_type
        self._options = option_keys(options_type)
        self._is_active = is_active
        self._check = check
        self._where = node.get_fully_qualified_name()
        given = {
            name: parameter.value
            for name, parameter in node.get_parameters_by_prefix("").items()
            if not is_of_ros(name)
        }
        scenario, options = self._resolve(given)
        check(scenario, options)
        for name in given:
            node.undeclare_parameter(name)
        for key in (*KEYS.values(), *self._options.values()):
            _declare(node, key, _expanded(given).get(key.name, key.default))
        node.add_on_set_parameters_callback(self._on_set)

    def read(self) -> tuple[Scenario, Options]:
        """Scenario and options as the parameters have them now."""
        return self._resolve(self._values())

    def _values(self) -> dict[str, Any]:
        values = {}
        for key in (*KEYS.values(), *self._options.values()):
            parameter = self._node.get_parameter_or(key.name)
            if parameter.type_ is not Parameter.Type.NOT_SET:
                values[key.name] = parameter.value
        return values

    def _resolve(self, values: Mapping[str, Any]) -> tuple[Scenario, Options]:
        given = {
            name: Given(
                value if isinstance(value, bool | int | float | str) else list(value), self._where
            )
            for name, value in values.items()
        }
        return resolve(given, self._options_type)

    def _on_set(self, parameters: list[Any]) -> Any:
        ours = [p for p in parameters if p.name in KEYS or p.name in self._options]
        if not ours:
            return SetParametersResult(successful=True)
        if self._is_active():
            names = ", ".join(parameter.name for parameter in ours)
            return _refuse(f"{names}: {self._where} is active, deactivate first.")
        values = self._values()
        values.update((parameter.name, parameter.value) for parameter in ours)
        try:
            self._check(*self._resolve(values))
        except ScenarioError as error:
            return _refuse(" ".join(error.problems))
        except JftoError as error:
            return _refuse(str(error))
        return SetParametersResult(successful=True)


def describe(key: Key, *, read_only: bool = False) -> ParameterDescriptor:
    """Descriptor of a key: what it is, its unit and range."""
    text = key.doc
    if key.range_text:
        text += f" [{key.range_text}]"
    elif key.unit:
        text += f" [{key.unit}]"
    descriptor = ParameterDescriptor(description=text, read_only=read_only)
    if not key.array and key.low is not None and key.high is not None:
        if key.kind == "int":
            limits = IntegerRange(from_value=int(key.low), to_value=int(key.high), step=0)
            descriptor.integer_range = [limits]
        elif key.kind == "float":
            bounds = FloatingPointRange(
                from_value=float(key.low), to_value=float(key.high), step=0.0
            )
            descriptor.floating_point_range = [bounds]
    return descriptor


def _declare(node: Any, key: Key, value: Any) -> None:
    if key.array:
        entries = list(value) if isinstance(value, list | tuple) else [value]
        typed = [_converted(key, entry) for entry in entries]
        # By type alone: rclpy takes an empty list for an array of bytes.
        default = typed or _TYPES[key.kind, True]
    else:
        default = _converted(key, value)
    descriptor = describe(key, read_only=key.name == "autostart")
    node.declare_parameter(key.name, default, descriptor, ignore_override=True)


def _converted(key: Key, value: Any) -> Any:
    """A whole number where a file may write one for a float or an int, as ROS wants it."""
    return {"float": float, "int": int}.get(key.kind, lambda same: same)(value)


def _expanded(given: Mapping[str, Any]) -> dict[str, Any]:
    """Given values, short-hands replaced by what they stand for."""
    values: dict[str, Any] = {}
    for name, value in given.items():
        names: Iterable[str] = RADIO_SHORTHANDS.get(name, (name,))
        values.update(dict.fromkeys(names, value))
    return values


def _refuse(reason: str) -> SetParametersResult:
    return SetParametersResult(successful=False, reason=reason)
