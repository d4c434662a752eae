"""ArduPilot's own grids of terrain, N46E007.DAT: the ground as the autopilot takes it.

A file holds blocks of 2048 bytes, each a grid of 28 heights northwards by 32 eastwards in whole
metres above sea level, a constant number of metres apart, that begins at a latitude and longitude
of its own and laps over its neighbours. A checksum (CRC-16, XMODEM) guards each. The autopilot
fetches them from its ground station and interpolates linearly, as is done here.
"""

from __future__ import annotations

import binascii
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from jfto_msgs_py.errors import TerrainError
from jfto_msgs_py.types import Array, Flags
from jfto_world.terrain.frame import LocalFrame
from jfto_world.terrain.layer import Heights
from jfto_world.terrain.packed import unpacked_bytes
from jfto_world.terrain.products import EGM96
from jfto_world.terrain.raster import around
from jfto_world.terrain.raster_file import SUFFIXES, check_file

_NORTH, _EAST = 28, 32
_CHECKED_BYTES = 1821
_BLOCK = np.dtype(
    [
        *(("filled", "<u8"), ("lat", "<i4"), ("lon", "<i4"), ("crc", "<u2")),
        *(("version", "<u2"), ("spacing_m", "<u2"), ("heights", "<i2", (_NORTH, _EAST))),
        *(("row", "<u2"), ("column", "<u2"), ("lon_deg", "<i2"), ("lat_deg", "i1")),
        ("rest", "V227"),
    ]
)
_CRC_AT = 16
_VERSION = 1
# A bit says whether a square of 4 by 4 heights was ever filled in; 8 squares lie eastwards.
_SQUARE, _SQUARES_EAST = 4, 8
# ArduPilot's sphere: metres a degree, along a meridian.
_METRES_PER_DEGREE = 0.011131884502145034 * 1e7


@dataclass(frozen=True)
class AutopilotGrid:
    """Blocks of one or several files as a layer.

    `lat`, `lon` (K,) are the south-western corners in degrees, `grids` (K, 28, 32) heights in
    metres above sea level, NaN where none was filled in; `spacing_m` apart.
    """

    name: str
    lat: Array
    lon: Array
    grids: Array
    spacing_m: float
    notes: tuple[str, ...] = ()
    system: str = "ArduPilot's grid"
    height_datum: str = EGM96.datum
    above_ellipsoid: bool = False
    placed: str = ""

    def cell_m(self, frame: LocalFrame) -> float:  # noqa: ARG002
        """Metres between heights."""
        return self.spacing_m

    def covers(self, lat_deg: Array, lon_deg: Array, beyond: float = 0.0) -> Flags:  # noqa: ARG002
        """Whether places lie in a block; nothing is known outside of them."""
        return np.isfinite(self._at(lat_deg, lon_deg)[1])

    def heights(
        self, lat_deg: Array, lon_deg: Array, spacing_m: float, cell_m: float, zero_is_void: bool
    ) -> Heights:
        """Heights under places, linear between those of the file."""
        del lat_deg, lon_deg, spacing_m, cell_m
        source = self
        if zero_is_void:
            source = replace(self, grids=np.where(self.grids == 0, np.nan, self.grids))
        return source._interpolated

    def middle(self) -> tuple[float, float]:
        """Latitude and longitude of the block in the middle, degrees."""
        lat = np.median(self.lat) + 0.5 * _NORTH * self.spacing_m / _METRES_PER_DEGREE
        lon = np.asarray(np.median(around(self.lon, float(self.lon[0]), 360.0)))
        lon = lon + 0.5 * _EAST * self.spacing_m / _METRES_PER_DEGREE / _shrunk(float(lat))
        return float(lat), float(around(np.asarray(lon), 0.0, 360.0))

    def extent_text(self) -> str:
        """What it covers, for messages."""
        high = self.lat.max() + (_NORTH - 1) * self.spacing_m / _METRES_PER_DEGREE
        lon = around(self.lon, float(self.lon[0]), 360.0)
        wide = (_EAST - 1) * self.spacing_m / _METRES_PER_DEGREE / _shrunk(float(self.lat.mean()))
        return (
            f"latitude {self.lat.min():.4f} to {high:.4f}, "
            f"longitude {lon.min():.4f} to {lon.max() + wide:.4f}"
        )

    @cached_property
    def _rows(self) -> tuple[Array, list[tuple[Array, NDArray[np.intp]]]]:
        """Latitudes of rows of blocks, rising, and in each longitudes, rising, with indices."""
        latitudes = np.unique(self.lat)
        rows = []
        for latitude in latitudes:
            (members,) = np.nonzero(self.lat == latitude)
            members = members[np.argsort(self.lon[members], kind="stable")]
            rows.append((self.lon[members], members))
        return latitudes, rows

    def _at(self, lat_deg: Array, lon_deg: Array) -> tuple[NDArray[np.intp], Array, Array]:
        """Block of each place, and rows northwards and columns eastwards in it, NaN outside."""
        lat, lon = (np.asarray(v, dtype=np.float64) for v in (lat_deg, lon_deg))
        lon = around(lon, 0.0, 360.0)
        latitudes, rows = self._rows
        block = np.full(lat.shape, -1, dtype=np.intp)
        row_of = np.searchsorted(latitudes, lat, side="right") - 1
        for row in np.unique(row_of[row_of >= 0]):
            here = row_of == row
            longitudes, members = rows[row]
            place = np.searchsorted(longitudes, lon[here], side="right") - 1
            block[here] = np.where(place >= 0, members[np.maximum(place, 0)], -1)
        north = (lat - self.lat[block]) * _METRES_PER_DEGREE / self.spacing_m
        scale = _shrunk((lat + self.lat[block]) / 2)
        east = (lon - self.lon[block]) * _METRES_PER_DEGREE * scale / self.spacing_m
        slack = 1e-6
        inside = (block >= 0) & (north <= _NORTH - 1 + slack) & (east <= _EAST - 1 + slack)
        return block, np.where(inside, north, np.nan), np.where(inside, east, np.nan)

    def _interpolated(self, lat_deg: Array, lon_deg: Array) -> Array:
        block, north, east = self._at(lat_deg, lon_deg)
        inside = np.isfinite(north)
        i = np.clip(np.floor(np.where(inside, north, 0.0)), 0, _NORTH - 2).astype(int)
        j = np.clip(np.floor(np.where(inside, east, 0.0)), 0, _EAST - 2).astype(int)
        a, b = north - i, east - j
        south = (1 - b) * self.grids[block, i, j] + b * self.grids[block, i, j + 1]
        upper = (1 - b) * self.grids[block, i + 1, j] + b * self.grids[block, i + 1, j + 1]
        return np.asarray((1 - a) * south + a * upper)


def open_autopilot_grids(paths: Sequence[Path], name: str) -> AutopilotGrid:
    """Blocks of files as one grid. Raises TerrainError for a file that is damaged or another's."""
    blocks = np.concatenate([_read_blocks(path) for path in paths])
    spacings, counts = np.unique(blocks["spacing_m"], return_counts=True)
    spacing_m = int(spacings[np.argmax(counts)])
    kept = blocks[blocks["spacing_m"] == spacing_m]
    notes: tuple[str, ...] = ()
    if len(kept) < len(blocks):
        left = f"{len(blocks) - len(kept)} of {len(blocks)} blocks are left from another"
        notes = (f"{name}: {left} TERRAIN_SPACING than {spacing_m} m and not used",)
    return AutopilotGrid(
        name=name,
        lat=kept["lat"] * 1e-7,
        lon=around(kept["lon"] * 1e-7, 0.0, 360.0),
        grids=np.where(_filled(kept["filled"]), kept["heights"].astype(np.float64), np.nan),
        spacing_m=float(spacing_m),
        notes=notes,
    )


def _read_blocks(path: Path) -> NDArray[np.void]:
    check_file(path)
    content = unpacked_bytes(path, SUFFIXES)
    if len(content) % _BLOCK.itemsize:
        raise TerrainError(
            f"{path} has {len(content)} bytes, ArduPilot's terrain has blocks of 2048. It is cut "
            "short, or another program's file; copy it again from the vehicle's card "
            "(APM/TERRAIN), or name an elevation model."
        )
    blocks = np.frombuffer(content, dtype=_BLOCK)
    # The file has room for blocks that were never asked for.
    numbers = np.flatnonzero((blocks["version"] != 0) | (blocks["spacing_m"] != 0))
    if not numbers.size:
        raise TerrainError(
            f"{path} holds no heights yet. Fly or connect the vehicle with TERRAIN_ENABLE 1, or "
            "name the SRTM tile (.hgt) of that place."
        )
    for number in numbers:
        _check_block(blocks[number], content, int(number), path)
    return blocks[numbers]


def _check_block(block: np.void, content: bytes, number: int, path: Path) -> None:
    start = number * _BLOCK.itemsize
    checked = bytearray(content[start : start + _CHECKED_BYTES])
    checked[_CRC_AT : _CRC_AT + 2] = b"\0\0"  # it was computed with itself at 0
    cure = "Delete the file from the vehicle's card and let the vehicle fetch it anew."
    if binascii.crc_hqx(bytes(checked), 0) != block["crc"]:
        raise TerrainError(f"{path}: block {number} is damaged, its checksum is wrong. {cure}")
    if block["version"] != _VERSION or not block["spacing_m"]:
        raise TerrainError(
            f"{path}: block {number} is of format {block['version']} with {block['spacing_m']} m "
            f"between heights; format {_VERSION} is known. {cure}"
        )
    if abs(block["lat"]) > 90e7 or abs(block["lon"]) > 180e7:
        raise TerrainError(f"{path}: block {number} lies nowhere on earth. {cure}")


def _filled(bits: NDArray[np.uint64]) -> Flags:
    """Which of the heights (K, 28, 32) were ever filled in."""
    north, east = np.indices((_NORTH, _EAST)) // _SQUARE
    shift = (east + _SQUARES_EAST * north).astype(np.uint64)
    return np.asarray((bits[:, None, None] >> shift) & np.uint64(1), dtype=bool)


def _shrunk(lat_deg: Array | float) -> Array:
    """A degree of longitude in degrees of latitude, as ArduPilot has it."""
    return np.maximum(np.cos(np.radians(lat_deg)), 0.01)
