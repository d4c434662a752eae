"""A georeferenced grid of heights, before it is cut and brought into the local frame."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from affine import Affine
from pyproj import CRS, Transformer

from jfto_msgs_py.errors import TerrainError
from jfto_msgs_py.types import Array
from jfto_world.terrain.placing import Placing, placing


def apply_affine(affine: Affine, x: Array, y: Array) -> tuple[Array, Array]:
    """Coordinates (x, y), arrays of one shape, mapped by an affine transformation."""
    return (
        affine.a * x + affine.b * y + affine.c,
        affine.d * x + affine.e * y + affine.f,
    )


# Projections whose eastings are proportional to longitude.
_CYLINDERS = (
    "Popular Visualisation Pseudo Mercator",
    "Mercator (variant A)",
    "Mercator (variant B)",
    "Equidistant Cylindrical",
    "Equidistant Cylindrical (Spherical)",
)


def around(values: Array, middle: float, turn: float) -> Array:
    """Angles of any shape brought within half a turn of `middle`."""
    near = np.abs(values - middle) <= turn / 2
    # Those that are near already keep their very bits.
    return np.where(near, values, middle + (values - middle + turn / 2) % turn - turn / 2)


@dataclass(frozen=True)
class Raster:
    """Where the cells of a raster are, and how to read them.

    `transform` maps (column, row) of a cell's corner to coordinates of `crs`, in its axis order
    "easting, northing". `read(row_start, row_stop, column_start, column_stop)` returns float64
    heights in metres above `height_datum`, NaN where there are none; it raises TerrainError.
    `notes` say what was taken for granted, a line each.
    """

    name: str
    shape: tuple[int, int]
    transform: Affine
    crs: CRS
    height_datum: str
    above_ellipsoid: bool
    read: Callable[[int, int, int, int], Array]
    notes: tuple[str, ...] = ()

    @cached_property
    def placing(self) -> Placing:
        """From WGS-84 to the raster's coordinates. Raises TerrainError where none is known."""
        return placing(self.crs, self.name, self._bounds_deg())

    def cells(self, lat_deg: Array, lon_deg: Array) -> tuple[Array, Array]:
        """Columns and rows, fractional, counted from the first cell's centre."""
        easting, northing = map(np.asarray, self.placing.transformer.transform(lon_deg, lat_deg))
        if self.turn:
            easting = around(easting, float(self._middle[0]), self.turn)
        columns, rows = apply_affine(~self.transform, easting, northing)
        return columns - 0.5, rows - 0.5

    @property
    def _middle(self) -> tuple[Array, Array]:
        rows, columns = self.shape
        return apply_affine(self.transform, np.array(columns / 2), np.array(rows / 2))

    @cached_property
    def turn(self) -> float:
        """A whole turn of the globe in units of the CRS, 0 where its eastings do not repeat."""
        if self.crs.is_geographic:
            return 2 * math.pi / self.crs.axis_info[0].unit_conversion_factor
        operation = self.crs.coordinate_operation
        if operation is None or operation.method_name not in _CYLINDERS:
            return 0.0
        eastings, _ = self.placing.transformer.transform([0.0, 1.0], [0.0, 0.0])
        return float(360.0 * abs(eastings[1] - eastings[0]))

    def _bounds_deg(self) -> tuple[float, float, float, float]:
        """West, south, east and north, roughly: on the raster's own datum."""
        rows, columns = self.shape
        x, y = apply_affine(
            self.transform,
            *(a.astype(float) for a in np.meshgrid([0, columns / 2, columns], [0, rows / 2, rows])),
        )
        base = self.crs.geodetic_crs or self.crs
        lon, lat = map(
            np.asarray, Transformer.from_crs(self.crs, base, always_xy=True).transform(x, y)
        )
        scale = math.degrees(base.axis_info[0].unit_conversion_factor)
        lon, lat = lon * scale, np.clip(lat * scale, -90, 90)
        if not (np.isfinite(lon).all() and np.isfinite(lat).all()):
            raise TerrainError(
                f"{self.name} lies outside the reach of its coordinate system {self.crs.name}. "
                "Check which one it is in, and set it with gdal_edit.py -a_srs EPSG:…."
            )
        lon = around(lon, float(lon[1, 1]), 360.0)
        west, east = (float(v + 180) % 360 - 180 for v in (lon.min(), lon.max()))
        return west, float(lat.min()), east, float(lat.max())

    def geodetic(self, column: Array, row: Array) -> tuple[Array, Array]:
        """Latitude and longitude of fractional columns and rows counted from cell centres."""
        easting, northing = apply_affine(
            self.transform, np.asarray(column) + 0.5, np.asarray(row) + 0.5
        )
        lon, lat = self.placing.transformer.transform(easting, northing, direction="INVERSE")
        return np.asarray(lat), around(np.asarray(lon), 0.0, 360.0)

    def extent_text(self) -> str:
        """What the raster covers, for messages."""
        rows, columns = self.shape
        along_column, along_row = np.meshgrid(
            np.linspace(0, columns - 1, 9), np.linspace(0, rows - 1, 9)
        )
        lat, lon = self.geodetic(along_column, along_row)
        # Across the date line it runs on beyond 180 degrees.
        lon = around(lon, float(lon[4, 4]), 360.0)
        return (
            f"latitude {lat.min():.4f} to {lat.max():.4f}, "
            f"longitude {lon.min():.4f} to {lon.max():.4f}"
        )
