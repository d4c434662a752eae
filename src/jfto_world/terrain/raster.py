"""A georeferenced grid of heights, before it is cut and brought into the local frame."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from affine import Affine
from pyproj import CRS, Transformer

from jfto_msgs_py.types import Array


def apply_affine(affine: Affine, x: Array, y: Array) -> tuple[Array, Array]:
    """Coordinates (x, y), arrays of one shape, mapped by an affine transformation."""
    return (
        affine.a * x + affine.b * y + affine.c,
        affine.d * x + affine.e * y + affine.f,
    )


@dataclass(frozen=True)
class Raster:
    """Where the cells of a raster are, and how to read them.

    `transform` maps (column, row) of a cell's corner to coordinates of `crs`, in its axis order
    "easting, northing". `read(row_start, row_stop, column_start, column_stop)` returns float64
    heights in metres above `height_datum`, NaN where there are none; it raises TerrainError.
    """

    name: str
    shape: tuple[int, int]
    transform: Affine
    crs: CRS
    height_datum: str
    above_ellipsoid: bool
    read: Callable[[int, int, int, int], Array]

    @cached_property
    def _from_wgs84(self) -> Transformer:
        return Transformer.from_crs("EPSG:4326", self.crs, always_xy=True)

    def cells(self, lat_deg: Array, lon_deg: Array) -> tuple[Array, Array]:
        """Columns and rows, fractional, counted from the first cell's centre."""
        easting, northing = self._from_wgs84.transform(lon_deg, lat_deg)
        columns, rows = apply_affine(~self.transform, np.asarray(easting), np.asarray(northing))
        return columns - 0.5, rows - 0.5

    def geodetic(self, column: Array, row: Array) -> tuple[Array, Array]:
        """Latitude and longitude of fractional columns and rows counted from cell centres."""
        easting, northing = apply_affine(
            self.transform, np.asarray(column) + 0.5, np.asarray(row) + 0.5
        )
        lon, lat = self._from_wgs84.transform(easting, northing, direction="INVERSE")
        return np.asarray(lat), np.asarray(lon)

    def extent_text(self) -> str:
        """What the raster covers, for messages."""
        rows, columns = self.shape
        along_column, along_row = np.meshgrid(
            np.linspace(0, columns - 1, 9), np.linspace(0, rows - 1, 9)
        )
        lat, lon = self.geodetic(along_column, along_row)
        return (
            f"latitude {lat.min():.4f} to {lat.max():.4f}, "
            f"longitude {lon.min():.4f} to {lon.max():.4f}"
        )
