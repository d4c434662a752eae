"""Elevation models on disk: GeoTIFF, SRTM .hgt, Esri ASCII and others, read through GDAL."""

from __future__ import annotations

import re
import warnings
import zipfile
from pathlib import Path

import numpy as np
import rasterio
from pyproj import CRS
from pyproj.exceptions import CRSError
from rasterio.errors import NotGeoreferencedWarning, RasterioError, RasterioIOError
from rasterio.windows import Window

from jfto_msgs_py.errors import TerrainError
from jfto_msgs_py.types import Array
from jfto_world.terrain.height_reference import DeclaredHeights, height_reference
from jfto_world.terrain.raster import Raster

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
# What people take for elevation models, and what to do instead.
_OTHERS = {
    ".dat": "ArduPilot's own cache of terrain, which tells no heights by itself: name the SRTM "
    "tile (.hgt) that it was made from",
    ".laz": "a point cloud: make a grid of it first (pdal, gdal_grid)",
    ".las": "a point cloud: make a grid of it first (pdal, gdal_grid)",
}
_PACKED = {".zip": "zip", ".gz": "gzip"}
_HGT_NAME = re.compile(r"[NS]\d{2}[EW]\d{3}", re.IGNORECASE)
# 3 arc-seconds, 1 arc-second, and 1 by 2 arc-seconds beyond 50 degrees of latitude.
_HGT_SAMPLES = {1201 * 1201: "3", 3601 * 3601: "1", 3601 * 1801: "1 x 2"}
_EGM96 = "EGM96 geoid (mean sea level)"


def open_raster(path: Path, declared: DeclaredHeights = AS_IN_FILE) -> Raster:
    """Raster of a file, of which only the header is read; `declared` fills what that leaves open.

    Raises TerrainError for a file that is missing, empty, of another format, cut short, an image,
    without a place on earth, or with heights of an unknown unit.
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
        shape, transform, suffix = dataset.shape, dataset.transform, kind_of(path)
        assumed = _EGM96 if suffix == ".hgt" else ""
        reference = height_reference(dataset.units[0], crs, path, declared, assumed)

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
    )


def kind_of(path: Path) -> str:
    """Suffix of a file in small letters, of one packed in .zip or .gz that of what is packed."""
    suffix = path.suffix.lower()
    if suffix == ".gz":
        return Path(path.stem).suffix.lower()
    return Path(_member(path)).suffix.lower() if suffix == ".zip" else suffix


def _member(path: Path) -> str:
    """Name of the one elevation model in a .zip."""
    try:
        with zipfile.ZipFile(path) as archive:
            names = [n for n in archive.namelist() if Path(n).suffix.lower() in FORMATS]
    except (OSError, zipfile.BadZipFile) as error:
        raise TerrainError(
            f"{path} cannot be unpacked ({error}). Copy or download it again."
        ) from error
    if len(names) != 1:
        raise TerrainError(
            f"{path} holds {len(names)} elevation models, must hold one. Unpack it and name the "
            "one, or the folder of neighbouring tiles."
        )
    return names[0]


def _check_file(path: Path) -> None:
    if not path.exists():
        raise TerrainError(f"{path} does not exist. Name a DEM file, or the built-in 'jacksboro'.")
    if not path.is_file():
        raise TerrainError(f"{path} is not a file. Name one DEM file.")
    size = path.stat().st_size
    if size == 0:
        raise TerrainError(f"{path} is empty. Copy or download it again.")
    suffix = kind_of(path)
    if suffix in _OTHERS:
        raise TerrainError(f"{path} is {_OTHERS[suffix]}.")
    if suffix not in FORMATS:
        raise TerrainError(
            f"{path} is of no known DEM format. Use GeoTIFF (.tif), SRTM (.hgt), Esri ASCII (.asc) "
            "or a GDAL mosaic (.vrt); gdal_translate converts others."
        )
    if suffix == ".hgt":
        packed = path.suffix.lower() in _PACKED
        if not _HGT_NAME.match(Path(_member(path)).name if path.suffix == ".zip" else path.name):
            raise TerrainError(
                f"{path} has no tile in its name, which alone says where it lies. "
                "Give it back its name, such as N40W106.hgt."
            )
        if not packed and (size % 2 or size // 2 not in _HGT_SAMPLES):
            raise TerrainError(
                f"{path} has {size} bytes, an SRTM tile has 2884802 (3 arc-seconds) or 25934402 "
                "(1 arc-second). It is cut short or still compressed; unpack or download it again."
            )


def _open(path: Path) -> rasterio.DatasetReader:
    suffix = kind_of(path)
    name = str(path)
    packed = _PACKED.get(path.suffix.lower())
    if packed:
        inner = f"/{_member(path)}" if packed == "zip" else ""
        name = f"/vsi{packed}/{path.absolute()}{inner}"
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
            kind_of(path) == ".asc"
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


def _horizontal(crs: CRS) -> CRS:
    """CRS without its heights, which are handled apart."""
    return crs.sub_crs_list[0] if crs.is_compound else crs.to_2d()
