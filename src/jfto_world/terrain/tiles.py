"""Elevation models in a folder: neighbouring tiles joined, others in layers, finest first."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from affine import Affine

from jfto_msgs_py.errors import TerrainError
from jfto_msgs_py.types import Array
from jfto_world.terrain.autopilot_grid import open_autopilot_grids
from jfto_world.terrain.height_reference import DeclaredHeights
from jfto_world.terrain.layer import Layer
from jfto_world.terrain.overlap import Overlap
from jfto_world.terrain.packed import PACKINGS, kind_of
from jfto_world.terrain.raster import Raster, apply_affine, around
from jfto_world.terrain.raster_file import AUTOPILOT, FORMATS, SUFFIXES, open_raster
from jfto_world.terrain.raster_layer import RasterLayer

# Of a cell: corners in files are rounded.
_ALIGNED = 0.05


def open_tiles(folder: Path, declared: DeclaredHeights) -> tuple[Layer, ...]:
    """The elevation models in a folder as layers. Raises TerrainError where they do not fit.

    Tiles of one grid are one layer, so that no seam is left between them.
    """
    files = sorted(path for path in folder.iterdir() if path.is_file())
    named = [path for path in files if path.suffix.lower() in (*SUFFIXES, *PACKINGS)]
    kinds = {path: kind_of(path, SUFFIXES) for path in named}
    tiles = [open_raster(path, declared) for path in named if kinds[path] in FORMATS]
    grids = [path for path in named if kinds[path] == AUTOPILOT]
    if not tiles and not grids:
        raise TerrainError(
            f"{folder} is not a file but a folder without an elevation model. Name a DEM "
            "file, or a folder of neighbouring tiles."
        )
    layers: list[Layer] = [_joined(group, folder) for group in _groups(tiles)]
    if grids:
        layers.append(open_autopilot_grids(grids, f"{folder} ({len(grids)} .DAT)"))
    return _of_one_datum(layers)


def _of_one_datum(layers: Sequence[Layer]) -> tuple[Layer, ...]:
    first = layers[0]
    for layer in layers:
        if layer.height_datum != first.height_datum:
            raise TerrainError(
                f"{layer.name} has another height datum than {first.name} ({layer.height_datum}, "
                f"{first.height_datum}): they are not tiles of one model. Move it elsewhere, "
                "convert one (gdalwarp), or declare terrain.vertical_datum where files are silent."
            )
    return tuple(layers)


def _groups(tiles: Sequence[Raster]) -> list[list[tuple[Raster, tuple[int, int]]]]:
    """Tiles of one grid each, with the rows and columns by which they lie from the first."""
    groups: list[list[tuple[Raster, tuple[int, int]]]] = []
    for tile in tiles:
        for group in groups:
            offset = _offset(group[0][0], tile)
            if offset is not None:
                group.append((tile, offset))
                break
        else:
            groups.append([(tile, (0, 0))])
    return groups


def _joined(group: Sequence[tuple[Raster, tuple[int, int]]], folder: Path) -> RasterLayer:
    first = group[0][0]
    if len(group) == 1:
        return RasterLayer(first)
    top, left = (min(offset[k] for _, offset in group) for k in range(2))
    placed = [(tile, row - top, column - left) for tile, (row, column) in group]
    shape = (
        max(row + tile.shape[0] for tile, row, _ in placed),
        max(column + tile.shape[1] for tile, _, column in placed),
    )
    overlap = Overlap()

    def read(row_start: int, row_stop: int, column_start: int, column_stop: int) -> Array:
        found = np.full((row_stop - row_start, column_stop - column_start), np.nan)
        owners: list[tuple[str, Array]] = []
        for tile, row, column in placed:
            rows = max(row_start, row), min(row_stop, row + tile.shape[0])
            columns = max(column_start, column), min(column_stop, column + tile.shape[1])
            if rows[0] >= rows[1] or columns[0] >= columns[1]:
                continue
            part = tile.read(rows[0] - row, rows[1] - row, columns[0] - column, columns[1] - column)
            here = np.s_[
                rows[0] - row_start : rows[1] - row_start,
                columns[0] - column_start : columns[1] - column_start,
            ]
            whole = np.full(found.shape, np.nan)
            whole[here] = part
            for other in owners:
                overlap.compare(other, (tile.name, whole))
            owners.append((tile.name, whole))
            # Neighbours share their edge; what one lacks there the other may hold.
            found = np.where(np.isnan(found), whole, found)
        return found

    joined = replace(
        first,
        name=f"{folder} ({len(group)} tiles)",
        shape=shape,
        transform=_moved(first.transform, left, top),
        read=read,
    )
    return RasterLayer(joined, overlap)


def _moved(transform: Affine, columns: int, rows: int) -> Affine:
    """The transform of a raster that begins so many cells on."""
    x, y = apply_affine(transform, np.array(columns), np.array(rows))
    a, b, _, d, e, _ = transform[:6]
    return Affine(a, b, float(x), d, e, float(y))


def _offset(first: Raster, tile: Raster) -> tuple[int, int] | None:
    """Rows and columns by which a tile lies from the first, None where its grid is another."""
    if first.crs != tile.crs or first.height_datum != tile.height_datum:
        return None
    ours, theirs = _cell(first.transform), _cell(tile.transform)
    if not np.allclose(ours, theirs, rtol=1e-6, atol=1e-6 * max(map(abs, ours))):
        return None
    x, y = tile.transform.c, tile.transform.f
    if first.turn:
        x = float(around(np.asarray(x), first.transform.c, first.turn))
    column, row = map(float, apply_affine(~first.transform, np.array(x), np.array(y)))
    if max(abs(column - round(column)), abs(row - round(row))) > _ALIGNED:
        return None
    return round(row), round(column)


def _cell(transform: Affine) -> tuple[float, ...]:
    """What a transform holds but for the corner."""
    a, b, _, d, e, _ = transform[:6]
    return a, b, d, e
