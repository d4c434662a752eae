"""Message and service classes by name, and messages filled from YAML."""

from __future__ import annotations

import importlib
from collections.abc import Callable
from typing import Any

import yaml

from jfto.ros_cli.errors import RosCommandError, last_line

_UNKNOWN = (AttributeError, ModuleNotFoundError, ValueError)


def message_class(name: str) -> Any:
    """Class of a message type; raises RosCommandError for an unknown one."""
    try:
        return _interface(name, "msg")
    except _UNKNOWN:
        raise RosCommandError("The passed message type is invalid") from None


def _interface(name: str, kind: str) -> Any:
    """Class of package/kind/Name, or package/Name for short."""
    package, *middle, leaf = name.split("/")
    if middle not in ([], [kind]):
        raise ValueError(name)
    return getattr(importlib.import_module(f"{package}.{kind}"), leaf)


def service_class(name: str) -> Any:
    """Class of a service type; raises RosCommandError for an unknown one."""
    try:
        return _interface(name, "srv")
    except _UNKNOWN:
        raise RosCommandError("The passed service type is invalid") from None


def read_yaml(text: str) -> Any:
    """Parse YAML; raises RosCommandError with what is wrong and where."""
    try:
        return yaml.safe_load(text)
    except yaml.YAMLError as error:
        raise RosCommandError(last_line(error)) from None


def fill(message: Any, values: Any) -> list[Callable[[Any], None]]:
    """Set fields from plain data; returns setters for the stamps that were given as `now`.

    A header given as `auto` and a stamp given as `now` take the time of sending: call each setter
    with it. Raises RosCommandError naming the field that cannot be set.
    """
    from rosidl_runtime_py import set_message_fields  # type: ignore[import-not-found]

    try:
        plain, stamps = _without_times(message, values)
        set_message_fields(message, plain)
    except Exception as error:  # noqa: BLE001 - whatever the classes refuse is the user's to know
        raise RosCommandError(f"Failed to populate field: {error}") from None
    return stamps


def _without_times(message: Any, values: Any) -> tuple[Any, list[Callable[[Any], None]]]:
    if not isinstance(values, dict):
        return values, []
    types = message.get_fields_and_field_types()
    plain: dict[Any, Any] = {}
    stamps: list[Callable[[Any], None]] = []
    for name, value in values.items():
        kind = types.get(name, "")
        if kind == "builtin_interfaces/Time" and value == "now":
            stamps.append(_stamp_setter(message, name))
        elif kind == "std_msgs/Header" and value == "auto":
            stamps.append(_stamp_setter(getattr(message, name), "stamp"))
        elif isinstance(value, dict) and kind.count("/") == 1 and "<" not in kind:
            plain[name], found = _without_times(getattr(message, name), value)
            stamps += found
        else:
            plain[name] = value
    return plain, stamps


def _stamp_setter(message: Any, name: str) -> Callable[[Any], None]:
    return lambda stamp: setattr(message, name, stamp)
