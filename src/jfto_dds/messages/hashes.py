"""RIHS01 type hashes: the SHA-256 of a type's canonical JSON description.

REP-2016 and rosidl's ``type_description`` define the format. rosbags computes it too, but not
for services and wrongly for ``char`` fields.
"""

from __future__ import annotations

import functools
import hashlib
import json

from jfto_dds.messages.definitions import FieldType, definition
from jfto_dds.messages.services import SERVICES

_TYPE_ID = {
    "int8": 2,
    "uint8": 3,
    "int16": 4,
    "uint16": 5,
    "int32": 6,
    "uint32": 7,
    "int64": 8,
    "uint64": 9,
    "float": 10,
    "double": 11,
    "boolean": 15,
    "octet": 16,
    "string": 17,
}
_MESSAGE_ID = 1
_BOUNDED_STRING_ID = 21
_ARRAY_OFFSET, _BOUNDED_OFFSET, _UNBOUNDED_OFFSET = 48, 96, 144


def _type_description(field: FieldType) -> dict[str, object]:
    if field.is_message:
        type_id = _MESSAGE_ID
    elif field.bound:
        type_id = _BOUNDED_STRING_ID
    else:
        type_id = _TYPE_ID[field.name]
    if field.container == "array":
        type_id += _ARRAY_OFFSET
    elif field.container == "sequence":
        type_id += _BOUNDED_OFFSET if field.size else _UNBOUNDED_OFFSET
    return {
        "type_id": type_id,
        "capacity": field.size,
        "string_capacity": field.bound,
        "nested_type_name": field.name if field.is_message else "",
    }


def type_fields(full_name: str) -> tuple[tuple[str, FieldType], ...]:
    """Fields as type descriptions list them: services have three, empty messages a dummy."""
    if full_name in SERVICES:
        return tuple(
            (f"{half.lower()}_message", FieldType(f"{full_name}_{half}"))
            for half in ("Request", "Response", "Event")
        )
    return definition(full_name).fields or (
        ("structure_needs_at_least_one_member", FieldType("uint8")),
    )


def referenced_types(full_name: str) -> list[str]:
    """Names of all types that a type contains, directly or not, sorted."""
    found: set[str] = set()
    pending = [full_name]
    while pending:
        for _, field in type_fields(pending.pop()):
            if field.is_message and field.name not in found:
                found.add(field.name)
                pending.append(field.name)
    return sorted(found)


def individual_description(full_name: str) -> dict[str, object]:
    """Describe one type without those it refers to, as plain dictionaries."""
    return {
        "type_name": full_name,
        "fields": [
            {"name": name, "type": _type_description(field)}
            for name, field in type_fields(full_name)
        ],
    }


@functools.cache
def type_hash(full_name: str) -> str:
    """Compute the RIHS01 hash of a message, a service or one half of a service."""
    description = {
        "type_description": individual_description(full_name),
        "referenced_type_descriptions": [
            individual_description(name) for name in referenced_types(full_name)
        ],
    }
    return "RIHS01_" + hashlib.sha256(json.dumps(description).encode()).hexdigest()
