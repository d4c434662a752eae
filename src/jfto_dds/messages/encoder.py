"""Generates, per message type, the function that appends a message's CDR to a buffer.

Runs of primitives, nested messages included, are packed by one precompiled ``struct``; that is
several times faster than field by field. Only little-endian is written, as ROS 2 does on every
machine it supports.
"""

from __future__ import annotations

import functools
import sys
from collections.abc import Callable
from typing import Any

import numpy as np

from jfto_dds.messages.definitions import FieldType, definition
from jfto_dds.messages.layout import (
    ELEMENT_SIZE,
    NUMERIC,
    NUMPY_CODE,
    STRUCT_CODE,
    padded_formats,
)

ENCAPSULATION = b"\x00\x01\x00\x00"
_PADDING = tuple(bytes(count) for count in range(8))
Encoder = Callable[[bytearray, Any], None]


def _align(buffer: bytearray, size: int) -> None:
    buffer += _PADDING[(4 - len(buffer)) % size]


_COUNT = padded_formats("I", "<")


def _append_count(buffer: bytearray, count: int) -> None:
    buffer += _COUNT[(len(buffer) - 4) & 7].pack(count)


def _append_string(buffer: bytearray, text: str) -> None:
    # A ROS string ends at its first NUL.
    data = text.encode().split(b"\0", 1)[0]
    _append_count(buffer, len(data) + 1)
    buffer += data
    buffer += b"\0"


def _append_block(buffer: bytearray, values: Any, size: int) -> None:
    if sys.byteorder == "big":
        values = values[:]
        values.byteswap()
    _align(buffer, size)
    buffer += values.tobytes()


def _append_numbers(buffer: bytearray, values: Any, size: int) -> None:
    _append_count(buffer, len(values))
    if values:
        _append_block(buffer, values, size)


def _append_fixed(buffer: bytearray, values: Any, dtype: str) -> None:
    array = np.ascontiguousarray(values, dtype=dtype)
    _align(buffer, array.itemsize)
    buffer += array.tobytes()


def _append_small(buffer: bytearray, values: Any) -> None:
    # Lists of booleans and octets: one byte each, never aligned.
    for value in values:
        buffer += value if isinstance(value, bytes) else (b"\1" if value else b"\0")


def _append_each(buffer: bytearray, values: Any, append: Encoder) -> None:
    for value in values:
        append(buffer, value)


class _Writer:
    """Collects the source lines of one encoder; pending primitives become one run."""

    def __init__(self) -> None:
        self.lines: list[str] = []
        self.names: dict[str, object] = {
            "append_string": _append_string,
            "append_count": _append_count,
            "append_numbers": _append_numbers,
            "append_fixed": _append_fixed,
            "append_small": _append_small,
            "append_each": _append_each,
        }
        self._codes = ""
        self._values: list[str] = []

    def primitive(self, code: str, value: str) -> None:
        """Add a primitive to the run in progress."""
        self._codes += code
        self._values.append(value)

    def flush(self) -> None:
        """End the run in progress."""
        if not self._codes:
            return
        name = f"run{len(self.names)}"
        self.names[name] = padded_formats(self._codes, "<")
        values = ", ".join(self._values)
        self.lines.append(f"buffer += {name}[(len(buffer) - 4) & 7].pack({values})")
        self._codes, self._values = "", []

    def call(self, line: str) -> None:
        """Add a line that is not part of a run."""
        self.flush()
        self.lines.append(line)

    def bind(self, value: object) -> str:
        """Give a helper object a name in the generated code."""
        name = f"bound{len(self.names)}"
        self.names[name] = value
        return name


def _write_container(out: _Writer, field: FieldType, value: str) -> None:
    fixed = field.container == "array"
    if field.name in NUMERIC:
        if fixed:
            dtype = "<" + NUMPY_CODE[field.name]
            out.call(f"append_fixed(buffer, {value}, '{dtype}')")
        else:
            out.call(f"append_numbers(buffer, {value}, {ELEMENT_SIZE[field.name]})")
        return
    if not fixed:
        out.call(f"append_count(buffer, len({value}))")
    if field.is_message:
        helper = out.bind(encoder(field.name))
        out.call(f"append_each(buffer, {value}, {helper})")
    elif field.name == "string":
        out.call(f"append_each(buffer, {value}, append_string)")
    else:
        out.call(f"append_small(buffer, {value})")


def _write_fields(out: _Writer, full_name: str, owner: str) -> None:
    fields = definition(full_name).fields
    if not fields:
        out.primitive("B", "0")
    for name, field in fields:
        value = f"{owner}._{name}"
        if field.container:
            _write_container(out, field, value)
        elif field.is_message:
            _write_fields(out, field.name, value)
        elif field.name == "string":
            out.call(f"append_string(buffer, {value})")
        else:
            out.primitive(STRUCT_CODE[field.name], value)


@functools.cache
def encoder(full_name: str) -> Encoder:
    """Build ``encode(buffer, message)``, which appends the body to a buffer.

    The buffer starts with the four bytes of encapsulation; alignment counts from behind them.
    """
    out = _Writer()
    _write_fields(out, full_name, "message")
    out.flush()
    body = "\n    ".join(out.lines)
    namespace = dict(out.names)
    source = f"def encode(buffer, message):\n    {body}\n"
    exec(source, namespace)  # noqa: S102 - built from type definitions, no outside text
    return namespace["encode"]  # type: ignore[return-value]
