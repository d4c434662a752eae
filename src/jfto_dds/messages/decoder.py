"""Generates, per message type, the function that reads a message from CDR bytes.

Every length is checked against what is left of the payload before anything is allocated, so a
malformed payload costs at most its own size. Both byte orders are read.
"""

from __future__ import annotations

import array
import functools
import struct
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
    least_size,
    padded_formats,
)


class MalformedPayloadError(ValueError):
    """The bytes are not a CDR encoding of the type they should be."""


# decode(payload, position) -> (message, position behind it)
Decoder = Callable[[bytes, int], tuple[Any, int]]
_NATIVE = "<" if sys.byteorder == "little" else ">"


class _Reader:
    """The primitives of one byte order, shared by all generated decoders."""

    def __init__(self, order: str) -> None:
        self.order = order
        self.counts = padded_formats("I", order)

    def count(self, payload: bytes, position: int, least: int, bound: int) -> tuple[int, int]:
        """Read a sequence length and refuse one that the payload cannot hold."""
        layout = self.counts[(position - 4) & 7]
        (count,) = layout.unpack_from(payload, position)
        position += layout.size
        if count * least > len(payload) - position:
            msg = f"a sequence claims {count} elements, {len(payload) - position} bytes are left"
            raise MalformedPayloadError(msg)
        if bound and count > bound:
            msg = f"a sequence bounded to {bound} elements claims {count}"
            raise MalformedPayloadError(msg)
        return count, position

    def string(self, payload: bytes, position: int) -> tuple[str, int]:
        """Read a string; its text ends at the first NUL."""
        layout = self.counts[(position - 4) & 7]
        (length,) = layout.unpack_from(payload, position)
        position += layout.size
        if length == 0:
            return "", position
        end = position + length
        if end > len(payload):
            msg = f"a string claims {length} bytes, {len(payload) - position} are left"
            raise MalformedPayloadError(msg)
        if payload[end - 1]:
            msg = "a string is not terminated by a NUL"
            raise MalformedPayloadError(msg)
        data = payload[position : end - 1]
        if b"\0" in data:
            data = data.split(b"\0", 1)[0]
        return data.decode("utf-8", "replace"), end

    def numbers(
        self, payload: bytes, position: int, code: str, size: int, bound: int
    ) -> tuple[array.array, int]:
        """Read a sequence of numbers into an array.array."""
        count, position = self.count(payload, position, size, bound)
        values = array.array(code)
        if count:
            position += (4 - position) % size
            end = position + count * size
            if end > len(payload):
                msg = f"a sequence claims {count} elements, the payload ends before"
                raise MalformedPayloadError(msg)
            values.frombytes(payload[position:end])
            if self.order != _NATIVE:
                values.byteswap()
            position = end
        return values, position

    def fixed(self, payload: bytes, position: int, dtype: str, count: int) -> tuple[Any, int]:
        """Read a fixed-size array of numbers into a numpy array of its own memory."""
        kind = np.dtype(self.order + dtype)
        position += (4 - position) % kind.itemsize
        end = position + count * kind.itemsize
        if end > len(payload):
            msg = "the payload ends inside a fixed-size array"
            raise MalformedPayloadError(msg)
        values = np.frombuffer(payload, kind, count, position)
        return values.astype(kind.newbyteorder("=")), end

    def small(self, payload: bytes, position: int, count: int, octet: bool) -> tuple[list, int]:
        """Read single bytes as booleans or as bytes of length one."""
        end = position + count
        if end > len(payload):
            msg = "the payload ends inside an array"
            raise MalformedPayloadError(msg)
        data = payload[position:end]
        if octet:
            return [data[i : i + 1] for i in range(count)], end
        return [value != 0 for value in data], end

    def each(self, payload: bytes, position: int, count: int, decode: Decoder) -> tuple[list, int]:
        """Read ``count`` messages or strings."""
        values = []
        for _ in range(count):
            value, position = decode(payload, position)
            values.append(value)
        return values, position


_READERS = {order: _Reader(order) for order in "<>"}


class _Source:
    """Collects the source lines of one decoder; pending primitives become one run."""

    def __init__(self, order: str) -> None:
        self.order = order
        self.lines: list[str] = []
        self.names: dict[str, object] = {"reader": _READERS[order]}
        self._codes = ""
        self._targets: list[str] = []
        self._objects = 0

    def primitive(self, code: str, target: str) -> None:
        """Add a primitive to the run in progress."""
        self._codes += code
        self._targets.append(target)

    def flush(self) -> None:
        """End the run in progress."""
        if not self._codes:
            return
        name = self.bind(padded_formats(self._codes, self.order))
        self.lines.append(f"layout = {name}[(position - 4) & 7]")
        self.lines.append(f"{', '.join(self._targets)}, = layout.unpack_from(payload, position)")
        self.lines.append("position += layout.size")
        self._codes, self._targets = "", []

    def read(self, target: str, call: str) -> None:
        """Assign what a reader method returns to a target."""
        self.flush()
        self.lines.append(f"{target}, position = {call}")

    def create(self, full_name: str) -> str:
        """Create a message without running its constructor; returns its local name."""
        cls = self.bind(_message_class(full_name))
        self._objects += 1
        local = f"message{self._objects}"
        self.lines.append(f"{local} = {cls}.__new__({cls})")
        self.lines.append(f"{local}._check_fields = True")
        return local

    def bind(self, value: object) -> str:
        """Give an object a name in the generated code."""
        name = f"bound{len(self.names)}"
        self.names[name] = value
        return name


def _message_class(full_name: str) -> type:
    from jfto_dds.messages.message_class import message_class

    return message_class(full_name)


def _read_container(out: _Source, field: FieldType, target: str) -> None:
    size = ELEMENT_SIZE.get(field.name, 0)
    bound = field.size if field.container == "sequence" else 0
    if field.name in NUMERIC:
        code = STRUCT_CODE[field.name]
        if field.container == "array":
            kind = NUMPY_CODE[field.name]
            out.read(target, f"reader.fixed(payload, position, '{kind}', {field.size})")
        else:
            out.read(target, f"reader.numbers(payload, position, '{code}', {size}, {bound})")
        return
    count = str(field.size)
    if field.container == "sequence":
        element = FieldType(field.name, field.bound)
        out.read("count", f"reader.count(payload, position, {least_size(element)}, {bound})")
        count = "count"
    if field.is_message:
        helper = out.bind(decoder(field.name, out.order))
        out.read(target, f"reader.each(payload, position, {count}, {helper})")
    elif field.name == "string":
        out.read(target, f"reader.each(payload, position, {count}, reader.string)")
    else:
        octet = field.name == "octet"
        out.read(target, f"reader.small(payload, position, {count}, {octet})")


def _read_fields(out: _Source, full_name: str) -> str:
    local = out.create(full_name)
    fields = definition(full_name).fields
    if not fields:
        out.primitive("B", "_")
    for name, field in fields:
        target = f"{local}._{name}"
        if field.container:
            _read_container(out, field, target)
        elif field.is_message:
            inner = _read_fields(out, field.name)
            out.lines.append(f"{target} = {inner}")
        elif field.name == "string":
            out.read(target, "reader.string(payload, position)")
        else:
            out.primitive(STRUCT_CODE[field.name], target)
    return local


@functools.cache
def decoder(full_name: str, order: str) -> Decoder:
    """Build ``decode(payload, position)`` for one type and byte order (``<`` or ``>``)."""
    out = _Source(order)
    local = _read_fields(out, full_name)
    out.flush()
    body = "\n    ".join([*out.lines, f"return {local}, position"])
    namespace = dict(out.names)
    source = f"def decode(payload, position):\n    {body}\n"
    exec(source, namespace)  # noqa: S102 - built from type definitions, no outside text
    return namespace["decode"]  # type: ignore[return-value]


def decode_message(payload: bytes, full_name: str, start: int = 4) -> Any:
    """Read one message from a payload with its encapsulation header, from byte ``start`` on.

    Bytes behind the message are ignored, as rmw_cyclonedds does.

    Raises
    ------
    MalformedPayloadError
        Wrong encapsulation, or the bytes end or contradict themselves before the message does.
    """
    if len(payload) < start or payload[0] or payload[1] > 1:
        msg = f"{len(payload)} bytes without a plain CDR encapsulation header"
        raise MalformedPayloadError(msg)
    try:
        message, _ = decoder(full_name, "<" if payload[1] else ">")(payload, start)
    except (struct.error, OverflowError) as error:
        msg = f"the payload ends before {full_name} does ({error})"
        raise MalformedPayloadError(msg) from error
    return message
