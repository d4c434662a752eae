"""Parameter values and files as rcl's own YAML reader takes them, which is not PyYAML's way.

Differences: ``010`` is 8, ``1_000`` and ``null`` are strings, lists must be of one type, aliases
are refused, and a key with nothing behind it is an error.
"""

from __future__ import annotations

import re
from typing import Any

import yaml

_TRUE = frozenset(["Y", "y", "yes", "Yes", "YES", "true", "True", "TRUE", "on", "On", "ON"])
_FALSE = frozenset(["N", "n", "no", "No", "NO", "false", "False", "FALSE", "off", "Off", "OFF"])
_INTEGER = re.compile(r"[-+]?(?:0[xX][0-9a-fA-F]+|0[0-7]*|[1-9][0-9]*)")
_FLOAT = re.compile(r"[-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][-+]?[0-9]+)?")
_SPECIAL = re.compile(r"([-+]?)\.(inf|Inf|INF|nan|NaN|NAN)")
_NATIVE_TAGS = {
    "tag:yaml.org,2002:str": str,
    "tag:yaml.org,2002:float": float,
}
_KIND = {bool: "bool", int: "integer", float: "double", str: "string"}


class ParameterYamlError(ValueError):
    """The text is not a legal parameter value or file; the message is rcl's."""


def _integer(text: str) -> int | None:
    if not _INTEGER.fullmatch(text):
        return None
    sign = -1 if text[0] == "-" else 1
    digits = text.lstrip("+-")
    if digits[:2].lower() == "0x":
        value = int(digits, 16)
    elif digits[0] == "0" and len(digits) > 1:
        value = int(digits, 8)
    else:
        value = int(digits)
    value *= sign
    return value if -(2**63) <= value < 2**63 else None


def _plain(text: str) -> bool | int | float | str:
    if text in _TRUE:
        return True
    if text in _FALSE:
        return False
    integer = _integer(text)
    if integer is not None:
        return integer
    special = _SPECIAL.fullmatch(text)
    if special:
        return float(special[1] + special[2].lower())
    return float(text) if _FLOAT.fullmatch(text) else text


def _scalar(node: yaml.ScalarNode) -> bool | int | float | str:
    # compose() resolves plain scalars to tags of its own; only the written style counts here.
    if node.style is not None:
        return node.value
    return _plain(node.value)


def _sequence(node: yaml.SequenceNode) -> list[Any]:
    values: list[Any] = []
    for item in node.value:
        if isinstance(item, yaml.SequenceNode):
            # rcl flattens nested lists.
            values.extend(_sequence(item))
        elif isinstance(item, yaml.ScalarNode):
            values.append(_scalar(item))
        else:
            msg = f"Unknown YAML event at line {item.start_mark.line + 1}"
            raise ParameterYamlError(msg)
        if values and type(values[-1]) is not type(values[0]):
            msg = (
                f"Sequence should be of same type. Value type '{_KIND[type(values[-1])]}' "
                f"do not belong at line_num {item.start_mark.line + 1}"
            )
            raise ParameterYamlError(msg)
    return values


def _value(node: yaml.Node) -> Any:
    if isinstance(node, yaml.SequenceNode):
        # An empty list has no type, which reads as a parameter without value.
        return _sequence(node) or None
    if isinstance(node, yaml.ScalarNode):
        value = _scalar(node)
        # rcl heeds this tag outside of lists only.
        if getattr(node, "is_float", False) and type(value) is int:
            return float(value)
        return value
    msg = "Unknown YAML event"
    raise ParameterYamlError(msg)


class _Loader(yaml.SafeLoader):
    """Reads explicit tags, so that ``!!str 5`` is told from ``5``."""

    def compose_scalar_node(self, anchor: Any) -> yaml.ScalarNode:
        event: Any = self.peek_event()
        node: Any = super().compose_scalar_node(anchor)
        wanted = _NATIVE_TAGS.get(event.tag)
        if wanted is str:
            node.style = '"'
        node.is_float = wanted is float
        return node

    def compose_node(self, parent: Any, index: Any) -> Any:
        if self.check_event(yaml.AliasEvent):
            event: Any = self.peek_event()
            msg = f"Will not support aliasing at line {event.start_mark.line + 1}"
            raise ParameterYamlError(msg)
        return super().compose_node(parent, index)


def _compose(text: str, failure: str) -> yaml.Node | None:
    loader = _Loader(text)
    try:
        return loader.get_single_node()
    except yaml.YAMLError as error:
        mark = getattr(error, "problem_mark", None)
        line = mark.line + 1 if mark is not None else 1
        raise ParameterYamlError(failure.format(line=line)) from None
    finally:
        loader.dispose()


def parse_parameter_value(text: str) -> Any:
    """Read the value of ``-p name:=value``; None for an empty list.

    Raises
    ------
    ParameterYamlError
        Not YAML, a map, or a list of several types.
    """
    node = _compose(text, "Error parsing an event")
    return _plain(text) if node is None else _value(node)


def _collect_parameters(node: yaml.MappingNode, prefix: str, found: dict[str, Any]) -> None:
    for key, value in node.value:
        name = f"{prefix}.{key.value}" if prefix else key.value
        if isinstance(value, yaml.MappingNode):
            _collect_parameters(value, name, found)
        elif isinstance(value, yaml.ScalarNode) and value.value == "" and value.style is None:
            msg = f"No value at line {value.start_mark.line + 1}"
            raise ParameterYamlError(msg)
        else:
            found[name] = _value(value)


def _collect_nodes(node: yaml.Node, key: str, found: dict[str, dict[str, Any]]) -> None:
    line = node.start_mark.line + 1
    if not isinstance(node, yaml.MappingNode):
        msg = f"Cannot have a value before ros__parameters at line {line}"
        raise ParameterYamlError(msg)
    for name, value in node.value:
        if name.value != "ros__parameters":
            child = name.value if key == "" else f"{key}/{name.value}"
            _collect_nodes(value, child, found)
            continue
        if key == "":
            msg = (
                f"There are no node names before ros__parameters at line {name.start_mark.line + 1}"
            )
            raise ParameterYamlError(msg)
        if not isinstance(value, yaml.MappingNode):
            msg = f"Cannot have a value before ros__parameters at line {name.start_mark.line + 1}"
            raise ParameterYamlError(msg)
        absolute = key if key.startswith("/") else f"/{key}"
        _collect_parameters(value, "", found.setdefault(absolute, {}))


def parse_parameter_file(text: str) -> dict[str, dict[str, Any]]:
    """Read a parameter file: node key to parameters, both in the order of the file.

    Raises
    ------
    ParameterYamlError
        Not YAML, or not of the form of a parameter file.
    """
    node = _compose(text, "Error parsing a event near line {line}")
    found: dict[str, dict[str, Any]] = {}
    if node is not None:
        _collect_nodes(node, "", found)
    return found


def node_key_matches(key: str, full_name: str) -> bool:
    """Whether a node key, ``/**``, ``/uav1/*`` or a full name, concerns a node."""
    pattern = re.escape(key).replace(r"/\*\*", r"(?:/\w+)*").replace(r"/\*", r"/\w+")
    return re.fullmatch(pattern, full_name) is not None
