"""Messages as YAML, CSV and ordered dictionaries, laid out as rosidl_runtime_py does."""

from __future__ import annotations

import array
from collections import OrderedDict
from typing import Any

import numpy as np
import yaml

DEFAULT_TRUNCATE_LENGTH = 128


def get_message_slot_types(msg: Any) -> OrderedDict:
    """Field names and the types of their values."""
    return OrderedDict(zip(msg.get_fields_and_field_types(), msg.SLOT_TYPES, strict=True))


def message_to_ordereddict(
    msg: Any,
    *,
    truncate_length: int | None = None,
    no_arr: bool = False,
    no_str: bool = False,
) -> OrderedDict:
    """Convert a message to plain data, with long arrays and strings cut on request."""
    result: OrderedDict = OrderedDict()
    for name, type_text in msg.get_fields_and_field_types().items():
        value = getattr(msg, name)
        if no_arr and _is_array(value):
            result[name] = _placeholder(msg, name, type_text, value)
        elif no_str and isinstance(value, str):
            result[name] = f"<string length: <{len(value)}>>"
        else:
            result[name] = _plain(value, truncate_length, no_arr, no_str)
    return result


def _is_array(value: Any) -> bool:
    return isinstance(value, (list, tuple, array.array, np.ndarray))


def _placeholder(msg: Any, name: str, type_text: str, value: Any) -> str:
    del msg, name
    if type_text.startswith("sequence<"):
        element = type_text[len("sequence<") : -1].partition(",")[0]
        kind = "sequence"
    else:
        element = type_text.partition("[")[0]
        kind = "array"
    if "/" in element and element.count("/") == 1:
        element = element.replace("/", "/msg/")
    return f"<{kind} type: {element}, length: {len(value)}>"


def _plain(value: Any, limit: int | None, no_arr: bool, no_str: bool) -> Any:
    if isinstance(value, bytes):
        if limit is not None and len(value) > limit:
            value = value[:limit] + b"..."
        return ord(value) if len(value) == 1 else value
    if isinstance(value, str):
        return value[:limit] + "..." if limit is not None and len(value) > limit else value
    if _is_array(value):
        cut = limit is not None and len(value) > limit
        items = [_plain(item, limit, no_arr, no_str) for item in (value[:limit] if cut else value)]
        return [*items, "..."] if cut else items
    if isinstance(value, np.generic):
        return value.item()
    if hasattr(value, "get_fields_and_field_types"):
        return message_to_ordereddict(value, truncate_length=limit, no_arr=no_arr, no_str=no_str)
    return value


class _Dumper(yaml.SafeDumper):
    """Keeps the order of fields and writes block lists."""


_Dumper.add_representer(
    OrderedDict,
    lambda dumper, data: dumper.represent_mapping("tag:yaml.org,2002:map", data.items()),
)


def message_to_yaml(
    msg: Any,
    *,
    truncate_length: int | None = None,
    no_arr: bool = False,
    no_str: bool = False,
    flow_style: bool = False,
) -> str:
    """Write a message as YAML, as ``ros2 topic echo`` prints it."""
    data = message_to_ordereddict(
        msg, truncate_length=truncate_length, no_arr=no_arr, no_str=no_str
    )
    return yaml.dump(
        data,
        Dumper=_Dumper,
        allow_unicode=True,
        width=float("inf"),
        default_flow_style=flow_style,
        sort_keys=False,
    )


def message_to_csv(
    msg: Any,
    *,
    truncate_length: int | None = None,
    no_arr: bool = False,
    no_str: bool = False,
) -> str:
    """Write the values of a message in one line, separated by commas."""

    def text(value: Any) -> str:
        if isinstance(value, list):
            return ",".join(text(item) for item in value)
        if isinstance(value, OrderedDict):
            return ",".join(text(item) for item in value.values())
        return str(value)

    return text(
        message_to_ordereddict(msg, truncate_length=truncate_length, no_arr=no_arr, no_str=no_str)
    )
