"""Reads an mcap file from front to back, as far as it goes: a killed recorder left no index."""

from __future__ import annotations

import struct
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

from rosbags.rosbag2.errors import ReaderError
from rosbags.rosbag2.storage_mcap import decompress, zstd

from jfto.bag.errors import BagError

MAGIC = b"\x89MCAP0\r\n"
# Record kinds: https://mcap.dev/spec, "Opcodes".
_SCHEMA, _CHANNEL, _MESSAGE, _CHUNK = 0x03, 0x04, 0x05, 0x06
_METADATA, _DATA_END = 0x0C, 0x0F
_RECORD_HEAD = struct.Struct("<BQ")
_MESSAGE_HEAD = struct.Struct("<HIQQ")
# What reading damaged records and chunks raises: bad text is a ValueError, lz4's a RuntimeError.
_DAMAGE = (ReaderError, ValueError, struct.error, zstd.ZstdError, RuntimeError)


@dataclass(frozen=True)
class Channel:
    """One topic in the file; `qos_text` is YAML."""

    number: int
    topic: str
    type_name: str
    encoding: str
    qos_text: str


@dataclass(frozen=True)
class ScannedMessage:
    """One message: when it was received, ns, and its bytes."""

    channel: int
    stamp_ns: int
    data: bytes


@dataclass
class McapScan:
    """What a file holds; `complete` says whether it was finished."""

    channels: dict[int, Channel] = field(default_factory=dict)
    messages: list[ScannedMessage] = field(default_factory=list)
    complete: bool = False


def scan_mcap(path: Path) -> McapScan:
    """Read all whole records of an mcap file. Raises BagError if it is none."""
    try:
        content = path.read_bytes()
    except OSError as error:
        raise BagError(f"{path}: cannot be read: {error.strerror}.") from None
    if not content.startswith(MAGIC):
        what = "is empty" if not content else "is no mcap file"
        raise BagError(f"{path}: {what}, nothing can be recovered.")
    scan = McapScan()
    try:
        scan.complete = _read_all(scan, memoryview(content)[len(MAGIC) :])
        scan.complete &= content.endswith(MAGIC)
    except _DAMAGE:
        # What follows damage cannot be trusted; what came before is whole.
        scan.complete = False
    return scan


def _read_all(scan: McapScan, data: memoryview) -> bool:
    """Take all records in; whether the data's end was reached."""
    schemas: dict[int, str] = {}
    for kind, body in _records(data):
        if kind == _CHUNK:
            for inner_kind, inner_body in _records(_chunk(body)):
                _take(scan, schemas, inner_kind, inner_body)
        elif kind == _DATA_END:
            return True
        else:
            _take(scan, schemas, kind, body)
    return False


def read_metadata_text(path: Path) -> str:
    """YAML that rosbag2 puts into its mcap files; the last one counts, the first is empty."""
    text = ""
    for kind, body in _records(memoryview(path.read_bytes())[len(MAGIC) :]):
        if kind == _METADATA:
            name, position = _text(body, 0)
            if name == "rosbag2":
                text = _text_map(body, position).get("serialized_metadata", text)
        elif kind == _DATA_END:
            break
    return text


def _records(data: memoryview) -> Iterator[tuple[int, memoryview]]:
    """Whole records; one that is cut off ends the walk."""
    position = 0
    while position + _RECORD_HEAD.size <= len(data):
        kind, size = _RECORD_HEAD.unpack_from(data, position)
        begin = position + _RECORD_HEAD.size
        if kind == 0 or begin + size > len(data):
            return
        yield kind, data[begin : begin + size]
        position = begin + size


def _chunk(body: memoryview) -> memoryview:
    size, crc = struct.unpack_from("<QI", body, 16)
    compression, position = _text(body, 28)
    (length,) = struct.unpack_from("<Q", body, position)
    packed = bytes(body[position + 8 : position + 8 + length])
    return memoryview(decompress(packed, compression, size, crc))


def _take(scan: McapScan, schemas: dict[int, str], kind: int, body: memoryview) -> None:
    if kind == _SCHEMA:
        (number,) = struct.unpack_from("<H", body)
        schemas[number] = _text(body, 2)[0]
    elif kind == _CHANNEL:
        channel = _channel(schemas, body)
        scan.channels[channel.number] = channel
    elif kind == _MESSAGE:
        number, _, stamp_ns, _ = _MESSAGE_HEAD.unpack_from(body)
        if number in scan.channels:
            data = bytes(body[_MESSAGE_HEAD.size :])
            scan.messages.append(ScannedMessage(number, stamp_ns, data))


def _channel(schemas: dict[int, str], body: memoryview) -> Channel:
    number, schema = struct.unpack_from("<HH", body)
    topic, position = _text(body, 4)
    encoding, position = _text(body, position)
    qos_text = _text_map(body, position).get("offered_qos_profiles", "")
    return Channel(number, topic, schemas.get(schema, ""), encoding, qos_text)


def _text_map(body: memoryview, position: int) -> dict[str, str]:
    (length,) = struct.unpack_from("<I", body, position)
    position, end = position + 4, position + 4 + length
    entries = {}
    while position < end:
        key, position = _text(body, position)
        entries[key], position = _text(body, position)
    return entries


def _text(data: memoryview, position: int) -> tuple[str, int]:
    (length,) = struct.unpack_from("<I", data, position)
    end = position + 4 + length
    return bytes(data[position + 4 : end]).decode(), end
