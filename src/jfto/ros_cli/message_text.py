"""Messages as YAML and CSV, laid out as `ros2 topic echo` prints them."""

from __future__ import annotations

import array
import sys
from collections import OrderedDict
from dataclasses import dataclass
from typing import Any

import numpy as np
import yaml

_ARRAYS = (list, tuple, array.array, np.ndarray)


@dataclass(frozen=True)
class TextLimits:
    """What is left out: arrays and strings beyond a length, all arrays, all strings."""

    truncate_length: int | None = 128
    no_arr: bool = False
    no_str: bool = False


class _Dumper(yaml.Dumper):
    """Keeps the order of fields; flow style reaches sequences but not the message itself."""

    def represent_ordered(self, data: OrderedDict) -> yaml.MappingNode:
        """Represent the fields of a message."""
        pairs = [
            (self.represent_data(key), self.represent_data(value)) for key, value in data.items()
        ]
        return yaml.MappingNode("tag:yaml.org,2002:map", pairs)


_Dumper.add_representer(OrderedDict, _Dumper.represent_ordered)


def to_yaml(message: Any, limits: TextLimits, *, flow_style: bool = False) -> str:
    """Write a message as YAML."""
    return yaml.dump(
        _plain_message(message, limits),
        Dumper=_Dumper,
        allow_unicode=True,
        default_flow_style=flow_style,
        sort_keys=False,
        width=sys.maxsize,
    )


def to_csv(message: Any, limits: TextLimits) -> str:
    """Write the values of a message in one line, separated by commas."""
    line = ""
    for name, kind in message.get_fields_and_field_types().items():
        # No comma after a beginning that is empty: ros2cli's lines are like that.
        line += ("," if line else "") + _csv_value(getattr(message, name), kind, limits)
    return line


def _csv_value(value: Any, kind: str, limits: TextLimits) -> str:
    if isinstance(value, _ARRAYS):
        return _csv_array(value, kind, limits)
    if hasattr(value, "get_fields_and_field_types"):
        return to_csv(value, limits)
    return str(_cut(value, limits.truncate_length))


def _csv_array(value: Any, kind: str, limits: TextLimits) -> str:
    if limits.no_arr and kind:
        return _array_summary(value, kind)
    line = ""
    for index, item in enumerate(value):
        line += "," if line else ""
        if limits.truncate_length is not None and index >= limits.truncate_length:
            return line + "..."
        line += _csv_value(item, "", limits)
    return line


def _cut(value: Any, limit: int | None) -> Any:
    if limit is None or not isinstance(value, (str, bytes)) or len(value) <= limit:
        return value
    return value[:limit] + "..." if isinstance(value, str) else value[:limit] + b"..."


def _plain_message(message: Any, limits: TextLimits) -> OrderedDict:
    return OrderedDict(
        (name, _plain(getattr(message, name), kind, limits))
        for name, kind in message.get_fields_and_field_types().items()
    )


def _plain(value: Any, kind: str, limits: TextLimits) -> Any:
    if isinstance(value, bytes):
        return _cut("".join(map(chr, value)), limits.truncate_length)
    if isinstance(value, str):
        summary = f"<string length: <{len(value)}>>"
        return summary if limits.no_str else _cut(value, limits.truncate_length)
    if isinstance(value, _ARRAYS):
        return _plain_array(value, kind, limits)
    if hasattr(value, "get_fields_and_field_types"):
        return _plain_message(value, limits)
    return value.item() if isinstance(value, np.generic) else value


def _plain_array(value: Any, kind: str, limits: TextLimits) -> Any:
    if limits.no_arr and kind:
        return _array_summary(value, kind)
    limit = limits.truncate_length
    cut = limit is not None and len(value) > limit
    items = [_plain(item, "", limits) for item in (value[:limit] if cut else value)]
    return [*items, "..."] if cut else items


def _array_summary(value: Any, kind: str) -> str:
    """`<array type: double[9]>` or `<sequence type: std_msgs/msg/String, length: 2>`."""
    if not kind.startswith("sequence<"):
        element, _, rest = kind.partition("[")
        return f"<array type: {_full_name(element)}[{rest}>"
    element, _, bound = kind[len("sequence<") : -1].partition(", ")
    size = f"[{bound}]" if bound else ""
    return f"<sequence type: {_full_name(element)}{size}, length: {len(value)}>"


def _full_name(element: str) -> str:
    return element.replace("/", "/msg/") if element.count("/") == 1 else element
