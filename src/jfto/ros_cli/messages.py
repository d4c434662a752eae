"""Message and service classes by name; messages as plain data, and filled from it."""

from __future__ import annotations

import array
import importlib
import re
import sys
import time
from dataclasses import dataclass
from typing import Any

import numpy as np
import yaml

from jfto.ros_cli import RosCommandError

_SEQUENCES = (list, tuple, array.array, np.ndarray)
_TIME, _HEADER = "builtin_interfaces/Time", "std_msgs/Header"


@dataclass(frozen=True)
class TextLimits:
    """What is left out: the rest of arrays and strings beyond a length, all arrays, all strings."""

    length: int | None = 128
    no_arrays: bool = False
    no_strings: bool = False


def message_class(name: str) -> Any:
    """Class of a message type, `std_msgs/msg/String`; raises RosCommandError for an unknown one."""
    return _interface(name, "msg")


def service_class(name: str) -> Any:
    """Class of a service type, `std_srvs/srv/Trigger`; raises RosCommandError if unknown."""
    return _interface(name, "srv")


def _interface(name: str, kind: str) -> Any:
    package, *middle, leaf = name.split("/")
    try:
        if middle in ([], [kind]):
            return getattr(importlib.import_module(f"{package}.{kind}"), leaf)
    except (ImportError, AttributeError, ValueError):
        pass
    raise RosCommandError(
        f"No type {name!r} in this ROS 2. Types are named like package/{kind}/Name, and "
        "their package has to be installed and sourced."
    )


def received_ns(info: dict[str, Any]) -> int:
    """When a message was received, ns since the epoch, by the info that came with it."""
    # Not every middleware says so.
    return int(info["received_timestamp"]) or time.time_ns()


def to_yaml(value: Any, limits: TextLimits | None = None) -> str:
    """A message, or one of its fields, as YAML."""
    plain = to_plain(value, "", limits or TextLimits(None))
    text = yaml.safe_dump(plain, sort_keys=False, allow_unicode=True, width=sys.maxsize)
    return text.removesuffix("...\n")


def to_plain(value: Any, kind: str, limits: TextLimits) -> Any:  # noqa: PLR0911 - one a kind
    """A message as a dictionary, arrays as lists, bytes as numbers.

    `kind` is the field's type as the message names it, "" for a message itself.
    """
    if hasattr(value, "get_fields_and_field_types"):
        fields = value.get_fields_and_field_types()
        return {name: to_plain(getattr(value, name), fields[name], limits) for name in fields}
    if isinstance(value, bytes):
        # Of a message, bytes are always one.
        return value[0]
    if isinstance(value, str):
        if limits.no_strings:
            return f"<{kind}, length: {len(value)}>"
        shown = value[: limits.length]
        return shown if shown == value else f"{shown}..."
    if isinstance(value, _SEQUENCES):
        if limits.no_arrays:
            return f"<{kind}, length: {len(value)}>"
        plain = [to_plain(each, kind, limits) for each in value[: limits.length]]
        return plain if len(plain) == len(value) else [*plain, "..."]
    return value.item() if isinstance(value, np.generic) else value


def read_yaml(text: str) -> dict[str, Any]:
    """Fields of a message; raises RosCommandError with what is wrong and where."""
    try:
        plain = yaml.safe_load(text)
    except yaml.YAMLError as error:
        raise RosCommandError(f"The values are not YAML: {error}") from None
    if not isinstance(plain, dict | None):
        raise RosCommandError(f"The values must be fields, as in '{{data: 1}}', not {text!r}.")
    return plain or {}


def fill(message: Any, values: dict[str, Any], now: Any = None) -> None:
    """Set fields from plain data.

    A header given as `auto` and a stamp given as `now` become `now`, a builtin_interfaces/Time.
    Raises RosCommandError naming the field that cannot be set.
    """
    kinds = message.get_fields_and_field_types()
    for name, value in values.items():
        if name not in kinds:
            known = ", ".join(kinds) or "none"
            raise RosCommandError(f"{type(message).__name__} has no field {name!r}, but: {known}.")
        field, kind = getattr(message, name), kinds[name]
        if now is not None and kind == _TIME and value == "now":
            setattr(message, name, now)
        elif now is not None and kind == _HEADER and value == "auto":
            field.stamp = now
        elif hasattr(field, "get_fields_and_field_types") and isinstance(value, dict):
            fill(field, value, now)
        else:
            _set(message, name, kind, value)


def _set(message: Any, name: str, kind: str, value: Any) -> None:
    # An array is written double[9], sequence<double> or sequence<double, 3>.
    many = kind.startswith("sequence<") or kind.endswith("]")
    element = re.split(r"[\[,>]", kind.removeprefix("sequence<"))[0] if many else kind
    try:
        items = [_element(element, each) for each in (value if many else [value])]
        # Unless told so, rclpy checks nothing.
        checked = type(message)(check_fields=True, **{name: items if many else items[0]})
    except (AssertionError, TypeError, ValueError, OverflowError):
        where = f"{type(message).__name__}.{name}"
        raise RosCommandError(f"{where} is of type {kind} and cannot be {value!r}.") from None
    setattr(message, name, getattr(checked, name))


def _element(kind: str, value: Any) -> Any:
    """One value as rclpy wants it for a field, or an element of one."""
    if "/" in kind:
        if not isinstance(value, dict):
            raise TypeError(value)
        message = message_class(kind)()
        fill(message, value)
        return message
    if kind == "octet":
        return value if isinstance(value, bytes) else bytes([value])
    return float(value) if kind in ("float", "double") else value
