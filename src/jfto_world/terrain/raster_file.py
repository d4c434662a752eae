"""Elevation models on disk: GeoTIFF, SRTM .hgt and Esri ASCII, read through GDAL."""

from __future__ import annotations

import re
import warnings
from pathlib import Path

import numpy as np
import rasterio
from pyproj import CRS
from pyproj.exceptions import CRSError
from rasterio.errors import NotGeoreferencedWarning, RasterioError, RasterioIOError
from rasterio.windows import Window

from jfto_msgs_py.errors import TerrainError
from jfto_msgs_py.types import Array
from jfto_world.terrain.raster import Raster

FORMATS = {
    ".tif": "GTiff",
    ".tiff": "GTiff",
    ".hgt": "SRTMHGT",
    ".asc": "AAIGrid",
}
_HGT_NAME = re.compile(r"[NS]\d{2}[EW]\d{3}", re.IGNORECASE)
# 3 arc-seconds, 1 arc-second, and 1 by 2 arc-seconds beyond 50 degrees of latitude.
_HGT_SAMPLES = {1201 * 1201: "3", 3601 * 3601: "1", 3601 * 1801: "1 x 2"}
_FOOT_M = {"ft": 0.3048, "foot": 0.3048, "feet": 0.3048, "us-ft": 1200 / 3937}
_FOOT_M |= {"us survey foot": 1200 / 3937, "ftus": 1200 / 3937}
_SEA_LEVEL = "mean sea level (the file names no vertical datum)"


def open_raster(path: Path) -> Raster:
    """Raster of a file, of which only the header is read.

    Raises TerrainError for a file that is missing, empty, of another format, cut short, an image,
    or without a place on earth.
    """
    _check_file(path)
    with _open(path) as dataset:
        if dataset.count > 1:
            raise TerrainError(
                f"{path} has {dataset.count} bands, an elevation model has one. "
                "It may be an orthophoto; name the elevation model, or extract its band."
            )
        if np.dtype(dataset.dtypes[0]).kind not in "iuf":
            raise TerrainError(
                f"{path} holds {dataset.dtypes[0]} values, not heights. Name an elevation model."
            )
        crs = _crs(dataset, path)
        to_metres, datum, above_ellipsoid = _heights(dataset, crs, path)
        shape, transform, suffix = dataset.shape, dataset.transform, path.suffix.lower()

    def read(row_start: int, row_stop: int, column_start: int, column_stop: int) -> Array:
        # GDAL searches a text grid from its top anyway, and where that is cut short it searches
        # without end unless all rows above are asked for too.
        first = 0 if suffix == ".asc" else row_start
        window = Window.from_slices((first, row_stop), (column_start, column_stop))
        try:
            with _open(path) as dataset:
                scale, offset = dataset.scales[0], dataset.offsets[0]
                band = dataset.read(1, window=window, masked=True)
        except RasterioError as error:
            raise TerrainError(
                f"{path} cannot be read to its end ({_reason(error)}). "
                "The file is damaged or cut short; copy or download it again."
            ) from error
        heights = band[row_start - first :].astype(np.float64).filled(np.nan)
        if suffix == ".hgt":
            heights[heights == -32768] = np.nan
        return (heights * scale + offset) * to_metres

    return Raster(str(path), shape, transform, _horizontal(crs), datum, above_ellipsoid, read)


def _check_file(path: Path) -> None:
    if not path.exists():
        raise TerrainError(f"{path} does not exist. Name a DEM file, or the built-in 'jacksboro'.")
    if not path.is_file():
        raise TerrainError(f"{path} is not a file. Name one DEM file.")
    suffix = path.suffix.lower()
    if suffix not in FORMATS:
        raise TerrainError(
            f"{path} is of no known DEM format. Use GeoTIFF (.tif), SRTM (.hgt) or Esri ASCII "
            "(.asc); gdal_translate converts others."
        )
    size = path.stat().st_size
    if size == 0:
        raise TerrainError(f"{path} is empty. Copy or download it again.")
    if suffix == ".hgt":
        if not _HGT_NAME.match(path.name):
            raise TerrainError(
                f"{path} has no tile in its name, which alone says where it lies. "
                "Give it back its name, such as N40W106.hgt."
            )
        if size % 2 or size // 2 not in _HGT_SAMPLES:
            raise TerrainError(
                f"{path} has {size} bytes, an SRTM tile has 2884802 (3 arc-seconds) or 25934402 "
                "(1 arc-second). It is cut short or still compressed; unpack or download it again."
            )


def _open(path: Path) -> rasterio.DatasetReader:
    driver = FORMATS[path.suffix.lower()]
    try:
        with warnings.catch_warnings():
            # A raster without a place on earth is refused below, in our own words.
            warnings.simplefilter("ignore", NotGeoreferencedWarning)
            return rasterio.open(path, driver=driver)
    except (RasterioIOError, RasterioError) as error:
        raise TerrainError(
            f"{path} cannot be read as {path.suffix.lower()} ({_reason(error)}). "
            "Check that the suffix fits the content, and copy or download the file again."
        ) from error


def _reason(error: Exception) -> str:
    cause = error.__cause__ or error
    return str(cause).strip().rstrip(".") or type(error).__name__


def _crs(dataset: rasterio.DatasetReader, path: Path) -> CRS:
    if dataset.transform.is_identity:
        raise TerrainError(
            f"{path} is not georeferenced. Give it a place with gdal_translate -a_ullr -a_srs."
        )
    if dataset.crs is None:
        bounds = dataset.bounds
        looks_geographic = (
            path.suffix.lower() == ".asc"
            and -180 <= bounds.left < bounds.right <= 360
            and -90 <= bounds.bottom < bounds.top <= 90
        )
        if looks_geographic:
            return CRS.from_epsg(4326)
        raise TerrainError(
            f"{path} names no coordinate system. Put a .prj file beside it, or set one with "
            "gdal_edit.py -a_srs EPSG:…"
        )
    try:
        return CRS.from_wkt(dataset.crs.to_wkt())
    except CRSError as error:
        raise TerrainError(
            f"{path} has a coordinate system that PROJ does not know ({error}). "
            "Convert it with gdalwarp -t_srs EPSG:4326."
        ) from error


def _horizontal(crs: CRS) -> CRS:
    """CRS without its heights, which are handled apart."""
    return crs.sub_crs_list[0] if crs.is_compound else crs.to_2d()


def _heights(dataset: rasterio.DatasetReader, crs: CRS, path: Path) -> tuple[float, str, bool]:
    """Metres per height unit, name of the height datum, and whether it is the ellipsoid."""
    unit = (dataset.units[0] or "m").strip().lower()
    to_metres = _FOOT_M.get(unit, 1.0)
    if path.suffix.lower() == ".hgt":
        return to_metres, "EGM96 geoid (mean sea level)", False
    vertical = crs.sub_crs_list[1] if crs.is_compound else None
    if vertical is not None:
        if unit == "m" or unit not in _FOOT_M:
            to_metres = vertical.axis_info[0].unit_conversion_factor
        return to_metres, vertical.name, "ellipsoid" in vertical.name.lower()
    if len(crs.axis_info) == 3:
        return to_metres, f"ellipsoid of {crs.name}", True
    return to_metres, _SEA_LEVEL, False
