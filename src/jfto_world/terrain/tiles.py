"""Neighbouring tiles of one elevation model as one raster."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from affine import Affine

from jfto_msgs_py.errors import TerrainError
from jfto_msgs_py.types import Array
from jfto_world.terrain.height_reference import DeclaredHeights
from jfto_world.terrain.raster import Raster, apply_affine, around
from jfto_world.terrain.raster_file import FORMATS, kind_of, open_raster

_PACKED = (".zip", ".gz")
# Of a cell: corners in files are rounded.
_ALIGNED = 0.05


def open_tiles(folder: Path, declared: DeclaredHeights) -> Raster:
    """The elevation models in a folder as one. Raises TerrainError where they do not fit."""
    paths = sorted(
        path
        for path in folder.iterdir()
        if path.is_file()
        and path.suffix.lower() in (*FORMATS, *_PACKED)
        and kind_of(path) in FORMATS
    )
    if not paths:
        raise TerrainError(
            f"{folder} is not a file but a folder without an elevation model. Name a DEM "
            "file, or a folder of neighbouring tiles."
        )
    tiles = [open_raster(path, declared) for path in paths]
    return tiles[0] if len(tiles) == 1 else _joined(tiles, folder)


def _joined(tiles: Sequence[Raster], folder: Path) -> Raster:
    first = tiles[0]
    offsets = [_offset(first, tile) for tile in tiles]
    top, left = (min(offset[k] for offset in offsets) for k in range(2))
    placed = [(row - top, column - left) for row, column in offsets]
    shape = (
        max(row + tile.shape[0] for (row, _), tile in zip(placed, tiles, strict=True)),
        max(column + tile.shape[1] for (_, column), tile in zip(placed, tiles, strict=True)),
    )

    def read(row_start: int, row_stop: int, column_start: int, column_stop: int) -> Array:
        found = np.full((row_stop - row_start, column_stop - column_start), np.nan)
        for (row, column), tile in zip(placed, tiles, strict=True):
            rows = max(row_start, row), min(row_stop, row + tile.shape[0])
            columns = max(column_start, column), min(column_stop, column + tile.shape[1])
            if rows[0] >= rows[1] or columns[0] >= columns[1]:
                continue
            part = tile.read(rows[0] - row, rows[1] - row, columns[0] - column, columns[1] - column)
            place = found[
                rows[0] - row_start : rows[1] - row_start,
                columns[0] - column_start : columns[1] - column_start,
            ]
            # Neighbours share their edge; what one lacks there the other may hold.
            place[...] = np.where(np.isnan(place), part, place)
        return found

    return replace(
        first,
        name=f"{folder} ({len(tiles)} tiles)",
        shape=shape,
        transform=_moved(first.transform, left, top),
        read=read,
    )


def _moved(transform: Affine, columns: int, rows: int) -> Affine:
    """The transform of a raster that begins so many cells on."""
    x, y = apply_affine(transform, np.array(columns), np.array(rows))
    a, b, _, d, e, _ = transform[:6]
    return Affine(a, b, float(x), d, e, float(y))


def _offset(first: Raster, tile: Raster) -> tuple[int, int]:
    """Rows and columns by which a tile lies from the first. Raises TerrainError."""
    for what, ours, theirs in (
        ("coordinate system", first.crs, tile.crs),
        ("height datum", first.height_datum, tile.height_datum),
    ):
        if ours != theirs:
            raise TerrainError(
                f"{tile.name} has another {what} than {first.name}: they are not tiles of one "
                "model. Move it elsewhere, or convert one (gdalwarp)."
            )
    same_cell = np.allclose(first.transform[:6:4], tile.transform[:6:4], rtol=1e-6)
    x, y = tile.transform.c, tile.transform.f
    if first.turn:
        x = float(around(np.asarray(x), first.transform.c, first.turn))
    column, row = map(float, apply_affine(~first.transform, np.array(x), np.array(y)))
    if not same_cell or max(abs(column - round(column)), abs(row - round(row))) > _ALIGNED:
        raise TerrainError(
            f"{tile.name} has other cells than {first.name}: they are not tiles of one model. "
            "Move it elsewhere, or merge them (gdal_merge.py)."
        )
    return round(row), round(column)
