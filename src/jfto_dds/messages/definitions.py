"""What a ROS 2 interface type is made of: its fields, constants and defaults.

Message definitions come from the Jazzy type store of rosbags; services, which rosbags does not
ship, from :mod:`jfto_dds.messages.services`.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass

from rosbags.interfaces import Nodetype
from rosbags.typesys import Stores, get_typestore

from jfto_dds.messages.services import SERVICES

# ``char`` of a .msg file is an unsigned byte in ROS 2, for bytes and for hashes alike.
_ROSIDL_NAME = {
    "bool": "boolean",
    "byte": "octet",
    "char": "uint8",
    "float32": "float",
    "float64": "double",
}
_DUMMY_FIELD = "structure_needs_at_least_one_member"

# The only defaults in these packages that are not zero; rosbags drops defaults.
_DEFAULTS: dict[str, dict[str, object]] = {
    "geometry_msgs/msg/Quaternion": {"w": 1.0},
    "sensor_msgs/msg/NavSatStatus": {"status": -2},
    "type_description_interfaces/srv/GetTypeDescription_Request": {"include_type_sources": True},
}


@dataclass(frozen=True)
class FieldType:
    """Type of one field: an element and, perhaps, a container around it.

    ``name`` is a rosidl basic name (``double``, ``octet``, ``string``) or a full message name;
    ``bound`` limits a string (0: none). ``container`` is empty, ``array`` (``size`` elements) or
    ``sequence`` (at most ``size``, 0: unbounded).
    """

    name: str
    bound: int = 0
    container: str = ""
    size: int = 0

    @property
    def is_message(self) -> bool:
        """Whether the element is another message."""
        return "/" in self.name

    def __str__(self) -> str:
        """The text that ``get_fields_and_field_types`` shows."""
        base = self.name
        if self.is_message:
            package, _, name = base.split("/")
            base = f"{package}/{name}"
        elif self.bound:
            base = f"string<{self.bound}>"
        if self.container == "array":
            return f"{base}[{self.size}]"
        if self.container == "sequence":
            return f"sequence<{base}, {self.size}>" if self.size else f"sequence<{base}>"
        return base


@dataclass(frozen=True)
class Definition:
    """One message type: ``fields`` and ``constants`` in the order of its .msg file."""

    full_name: str
    fields: tuple[tuple[str, FieldType], ...]
    constants: tuple[tuple[str, str, object], ...]
    defaults: dict[str, object]

    @property
    def package(self) -> str:
        """The package, ``std_msgs`` of ``std_msgs/msg/String``."""
        return self.full_name.split("/")[0]

    @property
    def name(self) -> str:
        """The bare name, ``String`` of ``std_msgs/msg/String``."""
        return self.full_name.split("/")[2]


@functools.cache
def _typestore() -> dict:
    return dict(get_typestore(Stores.ROS2_JAZZY).fielddefs)


def _convert(description: tuple) -> FieldType:
    kind, argument = description
    if kind == Nodetype.BASE:
        name, bound = argument
        return FieldType(_ROSIDL_NAME.get(name, name), bound)
    if kind == Nodetype.NAME:
        return FieldType(argument)
    element, size = argument
    inner = _convert(element)
    container = "array" if kind == Nodetype.ARRAY else "sequence"
    return FieldType(inner.name, inner.bound, container, size)


def parse_field_type(text: str, package: str) -> FieldType:
    """Read a field type as .srv files write it, ``Parameter[]`` or ``string``."""
    container, size = "", 0
    if text.endswith("]"):
        text, _, count = text[:-1].partition("[")
        bounded = count.startswith("<=")
        container = "array" if count and not bounded else "sequence"
        size = int(count.removeprefix("<=") or 0)
    if text[0].isupper():
        text = f"{package}/{text}"
    if "/" in text and text.count("/") == 1:
        text = text.replace("/", "/msg/")
    return FieldType(_ROSIDL_NAME.get(text, text), 0, container, size)


def _service_half(full_name: str) -> Definition | None:
    service, _, half = full_name.rpartition("_")
    if service not in SERVICES:
        return None
    if half == "Event":
        fields = (
            ("info", FieldType("service_msgs/msg/ServiceEventInfo")),
            ("request", FieldType(f"{service}_Request", 0, "sequence", 1)),
            ("response", FieldType(f"{service}_Response", 0, "sequence", 1)),
        )
        return Definition(full_name, fields, (), {})
    package = service.split("/")[0]
    lines = SERVICES[service][0 if half == "Request" else 1]
    pairs, constants = [], []
    for line in lines:
        type_text, name = line.split()[:2]
        if "=" in line:
            constants.append(
                (name, _ROSIDL_NAME.get(type_text, type_text), int(line.split("=")[1]))
            )
        else:
            pairs.append((name, parse_field_type(type_text, package)))
    return Definition(full_name, tuple(pairs), tuple(constants), _DEFAULTS.get(full_name, {}))


@functools.cache
def definition(full_name: str) -> Definition:
    """Look up ``package/msg/Name`` or one half of a service, ``package/srv/Name_Request``.

    Raises
    ------
    KeyError
        The type is not known here.
    """
    half = _service_half(full_name)
    if half is not None:
        return half
    constants, fields = _typestore()[full_name]
    return Definition(
        full_name,
        tuple((name, _convert(kind)) for name, kind in fields if name != _DUMMY_FIELD),
        tuple((name, _ROSIDL_NAME.get(kind, kind), value) for name, kind, value in constants),
        _DEFAULTS.get(full_name, {}),
    )


@functools.cache
def type_names() -> tuple[str, ...]:
    """Full names of all messages and services that are known, sorted."""
    return tuple(sorted([*_typestore(), *SERVICES]))


@functools.cache
def packages() -> dict[str, frozenset[str]]:
    """Package name to the kinds of interface it has (``msg``, ``srv``)."""
    found: dict[str, set[str]] = {}
    for full_name in type_names():
        package, kind, _ = full_name.split("/")
        found.setdefault(package, set()).add(kind)
    return {name: frozenset(kinds) for name, kinds in found.items()}
