"""Cyclone's view of a ROS type: an IDL class that carries ready-made CDR bytes.

The members are declared truthfully, so that other Cyclone programs see the real type, but
encoding is ours: Cyclone's pure Python codec needs 44 ms for a megabyte.
"""

from __future__ import annotations

import functools
import threading
from typing import Any

from cyclonedds.idl import make_idl_struct
from cyclonedds.idl import types as _types

from jfto_dds.messages.definitions import FieldType, definition
from jfto_dds.wire.names import type_name

# The binding's generics confuse the type checker.
idl: Any = _types
_PRIMITIVE: dict[str, Any] = {
    "boolean": bool,
    "octet": idl.byte,
    "int8": idl.int8,
    "uint8": idl.uint8,
    "int16": idl.int16,
    "uint16": idl.uint16,
    "int32": idl.int32,
    "uint32": idl.uint32,
    "int64": idl.int64,
    "uint64": idl.uint64,
    "float": idl.float32,
    "double": idl.float64,
    "string": str,
}
_SERVICE_HEADER = {"client_guid": idl.uint64, "sequence_number": idl.int64}
_lock = threading.RLock()


def _member(field: FieldType) -> Any:
    if field.is_message:
        element = _struct(field.name)
    elif field.bound:
        element = idl.bounded_str[field.bound]
    else:
        element = _PRIMITIVE[field.name]
    if field.container == "array":
        return idl.array[element, field.size]
    if field.container == "sequence":
        return idl.sequence[element, field.size] if field.size else idl.sequence[element]
    return element


def _members(full_name: str) -> dict[str, Any]:
    fields = definition(full_name).fields
    if not fields:
        return {"structure_needs_at_least_one_member": idl.uint8}
    return {name: _member(field) for name, field in fields}


@functools.cache
def _struct(full_name: str) -> Any:
    dds_name = type_name(full_name)
    return make_idl_struct(
        dds_name.rpartition("::")[2], dds_name.replace("::", "."), _members(full_name)
    )


@functools.cache
def topic_type(full_name: str, *, service: bool = False) -> Any:
    """Build the class to create a topic with; with ``service`` it starts with rmw's header."""
    with _lock:
        members = {**_SERVICE_HEADER, **_members(full_name)} if service else _members(full_name)
        dds_name = type_name(full_name)
        return make_idl_struct(dds_name.rpartition("::")[2], dds_name.replace("::", "."), members)
