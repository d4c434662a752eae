"""Writes ArduPilot's terrain files, from its documentation and apart from the reader.

Positions follow ArduPilot's Location: a sphere on which a metre is 89.83204953368922e-7 degrees of
latitude, longitudes divided by the cosine of the latitude half way.
"""

from __future__ import annotations

import math
import struct
from collections.abc import Callable
from pathlib import Path

E7_PER_METRE = 89.83204953368922
ROWS_APART, COLUMNS_APART = 24, 28


def _moved(lat_e7: int, lon_e7: int, north_m: float, east_m: float) -> tuple[int, int]:
    up = int(north_m * E7_PER_METRE)
    scale = max(math.cos(math.radians((lat_e7 + up / 2) * 1e-7)), 0.01)
    return lat_e7 + up, lon_e7 + int(east_m * E7_PER_METRE / scale)


def _crc16(data: bytes) -> int:
    crc = 0
    for byte in data:
        crc ^= byte << 8
        for _ in range(8):
            crc = (crc << 1) ^ 0x1021 if crc & 0x8000 else crc << 1
        crc &= 0xFFFF
    return crc


def write_degree(
    folder: Path,
    lat_deg: int,
    lon_deg: int,
    height: Callable[[float, float], float],
    *,
    rows: range,
    columns: range,
    spacing_m: int = 100,
    filled: int = (1 << 56) - 1,
) -> tuple[Path, list[tuple[float, float, int]]]:
    """A file of the degree whose south-western corner is given, with some of its blocks.

    Returns its path, and latitude, longitude and height of every grid point written.
    """
    name = f"{'S' if lat_deg < 0 else 'N'}{abs(lat_deg):02d}"
    name += f"{'W' if lon_deg < 0 else 'E'}{abs(lon_deg):03d}.DAT"
    corner = lat_deg * 10**7, lon_deg * 10**7
    stride = 1 + int(111_319 * math.cos(math.radians(lat_deg)) / (spacing_m * COLUMNS_APART)) + 2
    content = bytearray(2048 * stride * (rows.stop + 1))
    points = []
    for row in rows:
        for column in columns:
            lat_e7, lon_e7 = _moved(
                *corner, row * ROWS_APART * spacing_m, column * COLUMNS_APART * spacing_m
            )
            heights = []
            for x in range(28):
                for y in range(32):
                    lat, lon = (
                        v * 1e-7 for v in _moved(lat_e7, lon_e7, x * spacing_m, y * spacing_m)
                    )
                    heights.append(round(height(lat, lon)))
                    points.append((lat, lon, heights[-1]))

            def packed(crc: int, place=(lat_e7, lon_e7), cell=(row, column), body=tuple(heights)):
                head = struct.pack("<QiiHHH", filled, *place, crc, 1, spacing_m)
                tail = struct.pack("<HHhb", *cell, lon_deg, lat_deg)
                return head + struct.pack(f"<{len(body)}h", *body) + tail

            block = packed(_crc16(packed(0)))
            at = 2048 * (stride * row + column)
            content[at : at + len(block)] = block
    path = folder / name
    path.write_bytes(content)
    return path, points
