"""A raster under an area: the part of it that is needed, as a smooth surface."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np
from affine import Affine
from scipy import ndimage

from jfto_msgs_py.errors import TerrainError
from jfto_msgs_py.types import Array, Flags
from jfto_world.terrain.cubic_surface import CubicSurface
from jfto_world.terrain.frame import LocalFrame
from jfto_world.terrain.layer import Heights
from jfto_world.terrain.overlap import Overlap
from jfto_world.terrain.raster import Raster, apply_affine

# The Dead Sea's shore and Everest, with some room for mines and for noise.
LOWEST_M, HIGHEST_M = -600.0, 9000.0
# Cells read beyond those that are asked for, so that the spline's edge is far from them.
_RIM = 3
_STRIP_CELLS = 4_000_000


@dataclass(frozen=True)
class RasterLayer:
    """A raster as a layer; `overlap` tells how well the tiles agree that it is joined from."""

    raster: Raster
    overlap: Overlap = field(default_factory=Overlap)

    @property
    def name(self) -> str:
        """File or folder."""
        return self.raster.name

    @property
    def system(self) -> str:
        """Name of its coordinate system."""
        return self.raster.crs.name

    @property
    def height_datum(self) -> str:
        """What its heights are measured from."""
        return self.raster.height_datum

    @property
    def above_ellipsoid(self) -> bool:
        """Whether that is the ellipsoid."""
        return self.raster.above_ellipsoid

    @property
    def placed(self) -> str:
        """How well its places on earth are known."""
        return self.raster.placing.note

    @property
    def notes(self) -> tuple[str, ...]:
        """What was taken for granted, and how tiles differ that overlap."""
        return (*self.raster.notes, *self.overlap.notes())

    def cell_m(self, frame: LocalFrame) -> float:
        """The shorter side of a cell at the frame's origin, m; inf where it does not reach."""
        origin = frame.origin
        column, row = self.raster.cells(np.array(origin.lat_deg), np.array(origin.lon_deg))
        if not (np.isfinite(column) and np.isfinite(row)):
            return math.inf
        lat, lon = self.raster.geodetic(
            column + np.array([0.0, 1.0, 0.0]), row + np.array([0.0, 0.0, 1.0])
        )
        corner = frame.to_enu(lat, lon, 0.0)
        sides = np.linalg.norm(corner[1:] - corner[0], axis=-1)
        return float(sides.min())

    def covers(self, lat_deg: Array, lon_deg: Array, beyond: float = 0.0) -> Flags:
        """Whether places lie between the centres of its cells, or `beyond` cells outside."""
        columns, rows = self.raster.cells(lat_deg, lon_deg)
        height, width = self.raster.shape
        inside: Flags = (columns >= -beyond) & (columns <= width - 1 + beyond)
        return inside & (rows >= -beyond) & (rows <= height - 1 + beyond)

    def heights(
        self, lat_deg: Array, lon_deg: Array, spacing_m: float, cell_m: float, zero_is_void: bool
    ) -> Heights:
        """Heights under places. Raises TerrainError where they cannot be read or are absurd."""
        fewest = min(self.raster.shape) // 2
        block = max(1, min(round(spacing_m / cell_m), fewest))
        window = self._window(*self.raster.cells(lat_deg, lon_deg), block)
        grid = _read_blocks(self.raster, window, block, zero_is_void)
        half = (block - 1) / 2
        to_blocks = Affine(
            *(1 / block, 0.0, -(window[2] + half) / block),
            *(0.0, 1 / block, -(window[0] + half) / block),
        )
        self._check_heights(grid, to_blocks, lat_deg, lon_deg)
        void = np.isnan(grid)
        near_void = ndimage.binary_dilation(void, np.ones((3, 3), dtype=bool))
        if void.all():
            return lambda lat, lon: np.full(np.broadcast(lat, lon).shape, np.nan)
        if void.any():
            # Outside the area only: a neutral value that does not bend the spline inside it.
            nearest = ndimage.distance_transform_edt(
                void, return_distances=False, return_indices=True
            )
            grid = grid[tuple(nearest)]
        surface = CubicSurface.through(grid, 0.0, 0.0, 1.0, 1.0)

        def heights(lat: Array, lon: Array) -> Array:
            u, v = apply_affine(to_blocks, *self.raster.cells(lat, lon))
            found = surface.height_and_gradient(u, v)[0]
            return np.where(near_void[_cell_of(u, v, near_void.shape)], np.nan, found)

        return heights

    def middle(self) -> tuple[float, float]:
        """Latitude and longitude of its middle, degrees."""
        rows, columns = self.raster.shape
        lat, lon = self.raster.geodetic(np.array((columns - 1) / 2), np.array((rows - 1) / 2))
        return float(lat), float(lon)

    def extent_text(self) -> str:
        """What it covers, for messages."""
        return self.raster.extent_text()

    def _window(self, columns: Array, rows: Array, block: int) -> tuple[int, int, int, int]:
        """First and last but one row and column that are read, some beyond those asked for."""
        height, width = self.raster.shape
        margin = _RIM * block
        first_row = min(max(0, math.floor(rows.min()) - margin), height - 2)
        first_column = min(max(0, math.floor(columns.min()) - margin), width - 2)
        last_row = max(min(height, math.ceil(rows.max()) + margin + 1), first_row + 2)
        last_column = max(min(width, math.ceil(columns.max()) + margin + 1), first_column + 2)
        return first_row, last_row, first_column, last_column

    def _check_heights(
        self, grid: Array, to_blocks: Affine, lat_deg: Array, lon_deg: Array
    ) -> None:
        absurd = (grid < LOWEST_M) | (grid > HIGHEST_M)
        if not absurd.any():
            return
        used = np.zeros(grid.shape, dtype=bool)
        u, v = apply_affine(to_blocks, *self.raster.cells(lat_deg, lon_deg))
        used[_cell_of(u, v, grid.shape)] = True
        absurd &= ndimage.binary_dilation(used, np.ones((3, 3), dtype=bool))
        if not absurd.any():
            grid[(grid < LOWEST_M) | (grid > HIGHEST_M)] = np.nan
            return
        row, column = np.argwhere(absurd)[0]
        lat, lon = self.raster.geodetic(*apply_affine(~to_blocks, column, row))
        raise TerrainError(
            f"{self.name} has heights no ground on earth has, {grid[row, column]:g} m, first at "
            f"{float(lat):.5f}, {float(lon):.5f}. If this value marks missing data, declare it "
            "(gdal_edit.py -a_nodata); if heights are in other units, convert them to metres."
        )


def _cell_of(u: Array, v: Array, shape: tuple[int, ...]) -> tuple[Array, Array]:
    """Row and column of the cells nearest to block coordinates."""
    return (
        np.clip(np.rint(v).astype(int), 0, shape[0] - 1),
        np.clip(np.rint(u).astype(int), 0, shape[1] - 1),
    )


def _read_blocks(
    raster: Raster, window: tuple[int, int, int, int], block: int, zero_is_void: bool
) -> Array:
    """Heights of a window, averaged over block × block cells; one missing voids its block."""
    row_start, row_stop, column_start, column_stop = window
    width = column_stop - column_start
    columns = max(1, width // block)
    strips = []
    rows_at_once = max(1, _STRIP_CELLS // (width * block)) * block
    for row in range(row_start, row_stop, rows_at_once):
        strip = raster.read(row, min(row + rows_at_once, row_stop), column_start, column_stop)
        if zero_is_void:
            strip[strip == 0] = np.nan
        strip[np.isinf(strip)] = np.nan
        rows = len(strip) // block
        trimmed = strip[: rows * block, : columns * block]
        strips.append(trimmed.reshape(rows, block, columns, block).mean(axis=(1, 3)))
    return np.concatenate(strips)
