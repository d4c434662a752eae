"""Filling messages from plain data, as ``ros2 topic pub`` does."""

from __future__ import annotations

import array
from typing import Any

import numpy as np

from .utilities import get_message


def set_message_fields(
    msg: Any,
    values: dict[str, Any],
    expand_header_auto: bool = False,
    expand_time_now: bool = False,
) -> list[Any]:
    """Set fields from a dictionary; values are converted to the fields' types.

    Returns the setters of ``auto`` and ``now`` fields, which are not supported and so are none.

    Raises
    ------
    AttributeError
        No such field.
    ValueError, TypeError
        A value cannot be converted.
    """
    if expand_header_auto or expand_time_now:
        text = "jfto_dds does not support 'auto' headers and 'now' stamps"
        raise NotImplementedError(text)
    try:
        items = values.items()
    except AttributeError:
        text = f"Value '{values}' is expected to be a dictionary but is a {type(values).__name__}"
        raise TypeError(text) from None
    types = msg.get_fields_and_field_types()
    for name, value in items:
        current = getattr(msg, name)
        setattr(msg, name, _convert(current, value, types.get(name, "")))
    return []


def _convert(current: Any, value: Any, type_text: str) -> Any:
    if hasattr(current, "get_fields_and_field_types"):
        set_message_fields(current, value)
        return current
    if isinstance(current, array.array):
        number = float if current.typecode in "fd" else int
        return array.array(current.typecode, [number(item) for item in value])
    if isinstance(current, np.ndarray):
        return np.array(value, dtype=current.dtype)
    if isinstance(current, list):
        return [_element(item, type_text) for item in value]
    if isinstance(current, bytes):
        return value if isinstance(value, bytes) else bytes([int(value)])
    return type(current)(value)


def _element(value: Any, type_text: str) -> Any:
    name = type_text.removeprefix("sequence<").partition("[")[0].rstrip(">").partition(",")[0]
    if "/" in name:
        element = get_message(name)()
        set_message_fields(element, value)
        return element
    if name == "octet":
        return value if isinstance(value, bytes) else bytes([int(value)])
    return bool(value) if name == "boolean" else str(value)
