"""Telemetry logs that Mission Planner, MAVExplorer and mavlogdump open.

Each record is 8 bytes of big-endian Unix microseconds and one raw frame. Records are appended with
one write each, so a crash can only cut the last one short; reopening drops such a rest.
"""

from __future__ import annotations

import os
import struct
from collections.abc import Iterator
from pathlib import Path

from jfto_mavlink.io.framing import MAGIC_V1, MAGIC_V2, frame_length

STAMP = struct.Struct(">Q")
_STARTS = (bytes([MAGIC_V1]), bytes([MAGIC_V2]))


class TlogWriter:
    """Appends the frames of one vehicle, both directions."""

    def __init__(self, path: Path) -> None:
        path.parent.mkdir(parents=True, exist_ok=True)
        self.path = path
        if path.exists():
            whole = _whole_records(path.read_bytes())
            os.truncate(path, whole)
        self._fd = os.open(path, os.O_WRONLY | os.O_APPEND | os.O_CREAT, 0o644)

    def write(self, unix_us: int, raw: bytes) -> None:
        """Append one frame."""
        os.write(self._fd, STAMP.pack(unix_us) + raw)

    def close(self) -> None:
        """Close the file."""
        os.close(self._fd)


def read_tlog(path: Path) -> Iterator[tuple[int, bytes]]:
    """Unix microseconds and raw frame of each whole record."""
    data = path.read_bytes()
    start = 0
    while (length := _record_length(data, start)) is not None:
        yield STAMP.unpack_from(data, start)[0], data[start + 8 : start + length]
        start += length


def _whole_records(data: bytes) -> int:
    start = 0
    while (length := _record_length(data, start)) is not None:
        start += length
    return start


def _record_length(data: bytes, start: int) -> int | None:
    """Length of the record at `start`, None if it is not there in full."""
    header = start + STAMP.size
    length = frame_length(data, header) if data[header : header + 1] in _STARTS else None
    if length is None or header + length > len(data):
        return None
    return STAMP.size + length
