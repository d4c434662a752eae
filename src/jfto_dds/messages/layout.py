"""Where CDR puts things: element sizes, least encoded sizes, and runs of fixed-size members.

Plain CDR (XCDR version 1): a primitive of ``n`` bytes is aligned to ``n``, counted from the byte
after the four of the encapsulation header.
"""

from __future__ import annotations

import functools
import struct

from jfto_dds.messages.definitions import FieldType, definition

STRUCT_CODE = {
    "boolean": "?",
    "octet": "c",
    "int8": "b",
    "uint8": "B",
    "int16": "h",
    "uint16": "H",
    "int32": "i",
    "uint32": "I",
    "int64": "q",
    "uint64": "Q",
    "float": "f",
    "double": "d",
}
NUMPY_CODE = {
    "int8": "i1",
    "uint8": "u1",
    "int16": "i2",
    "uint16": "u2",
    "int32": "i4",
    "uint32": "u4",
    "int64": "i8",
    "uint64": "u8",
    "float": "f4",
    "double": "f8",
}
# Sequences of these are array.array and fixed arrays of them numpy arrays, as in rclpy.
NUMERIC = frozenset(NUMPY_CODE)
ELEMENT_SIZE = {name: struct.calcsize(f"<{code}") for name, code in STRUCT_CODE.items()}


@functools.cache
def least_size(field: FieldType) -> int:
    """The fewest bytes that one value of this type can take, padding left out.

    A declared sequence length times this cannot exceed what is left of a payload, which is how
    a malformed length is found before anything is allocated for it.
    """
    if field.container == "sequence":
        return 4
    if field.is_message:
        fields = definition(field.name).fields
        size = sum(least_size(kind) for _, kind in fields) or 1
    elif field.name == "string":
        size = 4
    else:
        size = ELEMENT_SIZE[field.name]
    return size * field.size if field.container == "array" else size


def padded_formats(codes: str, order: str) -> tuple[struct.Struct, ...]:
    """Build the eight layouts of a run of primitives, one per start offset modulo 8.

    Each begins with the padding that its offset needs, so that one ``pack`` or ``unpack_from``
    moves the whole run.
    """
    layouts = []
    for start in range(8):
        offset, parts = start, [order]
        for code in codes:
            size = struct.calcsize(f"<{code}")
            padding = -offset % size
            parts.append("x" * padding + code)
            offset += padding + size
        layouts.append(struct.Struct("".join(parts)))
    return tuple(layouts)
