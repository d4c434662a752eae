"""Rasters in files that GDAL reads."""

from __future__ import annotations

import math
import re
import warnings
from pathlib import Path

import numpy as np
import rasterio
from pyproj import CRS
from pyproj.exceptions import CRSError
from rasterio.enums import ColorInterp
from rasterio.errors import NotGeoreferencedWarning, RasterioError, RasterioIOError
from rasterio.windows import Window

from jfto_msgs_py.errors import TerrainError
from jfto_msgs_py.types import Array
from jfto_world.terrain import packed
from jfto_world.terrain.height_reference import DeclaredHeights, height_reference
from jfto_world.terrain.mosaic_file import mosaic_files
from jfto_world.terrain.products import product_of
from jfto_world.terrain.raster import Raster, apply_affine

AS_IN_FILE = DeclaredHeights()

FORMATS = {
    ".tif": "GTiff",
    ".tiff": "GTiff",
    ".hgt": "SRTMHGT",
    ".asc": "AAIGrid",
    ".vrt": "VRT",
    ".img": "HFA",
    ".bil": "EHdr",
    ".flt": "EHdr",
    ".dt0": "DTED",
    ".dt1": "DTED",
    ".dt2": "DTED",
}
# ArduPilot's own grids of terrain, which GDAL doesn't know.
AUTOPILOT = ".dat"
SUFFIXES = frozenset((*FORMATS, AUTOPILOT))
# What people take for elevation models, and what to do instead.
_OTHERS = {
    ".laz": "a point cloud: make a grid of it first (pdal, gdal_grid)",
    ".las": "a point cloud: make a grid of it first (pdal, gdal_grid)",
}
_HGT_NAME = re.compile(r"[NS]\d{2}[EW]\d{3}", re.IGNORECASE)
# 3 arc-seconds, 1 arc-second, and 1 by 2 arc-seconds beyond 50 degrees of latitude.
_HGT_SAMPLES = {1201 * 1201: "3", 3601 * 3601: "1", 3601 * 1801: "1 x 2"}
# Longitudes of files run up to some turns; cells of maps in metres are not finer than this.
_MOST_DEGREES, _LEAST_CELL_M = 1080.0, 0.01


def open_raster(path: Path, declared: DeclaredHeights = AS_IN_FILE) -> Raster:
    """Raster of a file, of which only the header is read; `declared` fills what that leaves open.

    Raises TerrainError for a file that is missing, empty, of another format, cut short, an image,
    without a place on earth, or with heights of an unknown unit.
    """
    check_file(path)
    suffix = packed.kind_of(path, SUFFIXES)
    if suffix == ".vrt":
        mosaic_files(path)
    with _open(path) as dataset:
        _check_content(dataset, path)
        crs = _crs(dataset, path)
        shape, transform = dataset.shape, dataset.transform
        product = product_of(packed.inner_name(path, SUFFIXES), suffix)
        reference = height_reference(dataset.units[0], crs, path, declared, product)

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
        return (heights * scale + offset) * reference.to_metres

    return Raster(
        str(path),
        shape,
        transform,
        _horizontal(crs),
        reference.datum,
        reference.above_ellipsoid,
        read,
        reference.notes,
    )


def check_file(path: Path) -> None:
    """Raise TerrainError for a file that is missing, empty, of another format or cut short."""
    if not path.exists():
        raise TerrainError(f"{path} does not exist. Name a DEM file, or the built-in 'jacksboro'.")
    if not path.is_file():
        raise TerrainError(f"{path} is not a file. Name one DEM file.")
    size = path.stat().st_size
    if size == 0:
        raise TerrainError(f"{path} is empty. Copy or download it again.")
    suffix = packed.kind_of(path, SUFFIXES)
    if suffix in _OTHERS:
        raise TerrainError(f"{path} is {_OTHERS[suffix]}.")
    if suffix not in SUFFIXES:
        raise TerrainError(
            f"{path} is of no known DEM format. Use GeoTIFF (.tif), SRTM (.hgt), Esri ASCII (.asc) "
            "or a GDAL mosaic (.vrt); gdal_translate converts others."
        )
    if suffix == ".hgt":
        _check_srtm(path, size)


def _check_srtm(path: Path, size: int) -> None:
    if not _HGT_NAME.match(packed.inner_name(path, SUFFIXES)):
        raise TerrainError(
            f"{path} has no tile in its name, which alone says where it lies. "
            "Give it back its name, such as N40W106.hgt."
        )
    is_packed = path.suffix.lower() in packed.PACKINGS
    if is_packed:
        size = packed.unpacked_size(path, SUFFIXES)
    if size % 2 or size // 2 not in _HGT_SAMPLES:
        sizes = [f"{2 * n} ({step} arc-seconds)" for n, step in sorted(_HGT_SAMPLES.items())]
        raise TerrainError(
            f"{path} {'holds a tile of' if is_packed else 'has'} {size} bytes, an SRTM tile has "
            f"{', '.join(sizes[:-1])} or {sizes[-1]}. It is cut short or "
            "still compressed; unpack or download it again."
        )


def _check_content(dataset: rasterio.DatasetReader, path: Path) -> None:
    if dataset.count > 1:
        raise TerrainError(
            f"{path} has {dataset.count} bands, an elevation model has one. "
            "It may be an orthophoto; name the elevation model, or extract its band."
        )
    if dataset.colorinterp[0] == ColorInterp.palette:
        raise TerrainError(
            f"{path} holds numbers of colours from a palette, a picture, not heights. "
            "Name the elevation model that it was drawn from."
        )
    if np.dtype(dataset.dtypes[0]).kind not in "iuf":
        raise TerrainError(
            f"{path} holds {dataset.dtypes[0]} values, not heights. Name an elevation model."
        )


def _open(path: Path) -> rasterio.DatasetReader:
    suffix = packed.kind_of(path, SUFFIXES)
    name = packed.vsi_path(path, SUFFIXES)
    try:
        with warnings.catch_warnings():
            # A raster without a place on earth is refused below, in our own words.
            warnings.simplefilter("ignore", NotGeoreferencedWarning)
            return rasterio.open(name, driver=FORMATS[suffix])
    except (RasterioIOError, RasterioError) as error:
        raise TerrainError(
            f"{path} cannot be read as {suffix} ({_reason(error)}). "
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
            packed.kind_of(path, SUFFIXES) == ".asc"
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
        found = CRS.from_wkt(dataset.crs.to_wkt())
        if found.geodetic_crs is not None:
            _check_place(dataset, found, path)
            return found
        raise TerrainError(
            f"{path} is in a local system ({found.name}), which says nothing of where on earth it "
            "lies. Give it its place with gdal_edit.py -a_srs EPSG:…."
        )
    except CRSError as error:
        raise TerrainError(
            f"{path} has a coordinate system that PROJ does not know ({error}). "
            "Convert it with gdalwarp -t_srs EPSG:4326."
        ) from error


def _check_place(dataset: rasterio.DatasetReader, crs: CRS, path: Path) -> None:
    """Refuse metres that are said to be degrees, and degrees that are said to be metres."""
    transform = dataset.transform
    cell = min(math.hypot(transform.a, transform.d), math.hypot(transform.b, transform.e))
    corners = np.array([[0, dataset.width] * 2, [0] * 2 + [dataset.height] * 2], dtype=np.float64)
    corner = float(np.abs(apply_affine(transform, *corners)).max())
    horizontal = _horizontal(crs)
    if horizontal.is_geographic:
        degrees = math.degrees(horizontal.axis_info[0].unit_conversion_factor)
        if corner * degrees > _MOST_DEGREES:
            raise TerrainError(
                f"{path} is said to be in degrees ({horizontal.name}), but has coordinates up to "
                f"{corner:.0f}: metres of a map. Set its own system with gdal_edit.py -a_srs "
                "EPSG:…."
            )
    elif cell < _LEAST_CELL_M and corner <= _MOST_DEGREES:
        raise TerrainError(
            f"{path} is said to be in metres ({horizontal.name}), but has cells of {cell:.3g} and "
            f"coordinates up to {corner:.4g}: degrees. Set its own system with gdal_edit.py -a_srs "
            "EPSG:4326."
        )


def _horizontal(crs: CRS) -> CRS:
    """CRS without its heights, which are handled apart."""
    return crs.sub_crs_list[0] if crs.is_compound else crs.to_2d()
