"""Layers of KML, GeoJSON, Shapefile and GeoPackage files, read through GDAL, in WGS-84 degrees."""

from __future__ import annotations

import math
import warnings
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pyogrio.raw
import shapely
from pyogrio.errors import CRSError as OgrCrsError
from pyogrio.errors import DataLayerError, DataSourceError, FeatureError, FieldError, GeometryError
from pyproj import CRS, Transformer
from pyproj.exceptions import ProjError
from shapely.errors import ShapelyError
from shapely.geometry.base import BaseGeometry

from jfto_msgs_py.errors import SiteError, TerrainError
from jfto_world.terrain.placing import placing

_OGR_ERRORS = (
    DataSourceError, DataLayerError, FeatureError, FieldError, GeometryError, OgrCrsError,
)  # fmt: skip
_MOST_FEATURES, _MOST_CORNERS = 10_000, 200_000
_UNCLOSED = "Non closed ring"
# Since 2.1 rings left open are closed; with 2.0, Ubuntu 24.04's, such a file is refused.
_ON_INVALID = "fix" if (*map(int, shapely.__version__.split(".")[:2]),) >= (2, 1) else "raise"
_NAMES = ("name", "title", "label")


@dataclass(frozen=True)
class Feature:
    """A feature: `geometry` in degrees, longitude before latitude, None where it has none."""

    place: str
    name: str
    geometry: BaseGeometry | None
    properties: dict[str, Any]


@dataclass(frozen=True)
class Layer:
    """Features of a layer, and notes on what was read otherwise than it stands."""

    name: str
    features: tuple[Feature, ...]
    notes: tuple[str, ...]


def layer_names(path: str) -> tuple[str, ...]:
    """Names of the layers of a file that GDAL can read. Raises SiteError."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", RuntimeWarning)
            return tuple(str(name) for name in pyogrio.list_layers(path)[:, 0])
    except _OGR_ERRORS as error:
        raise SiteError(
            f"{path}: cannot be read ({_short(error)}). The file is damaged or of another kind "
            "than its name says; export it again."
        ) from None


def read_layer(path: str, name: str) -> Layer:
    """Features of one layer in degrees. Raises SiteError."""
    notes: list[str] = []
    meta, geometries, columns = _raw(path, name, notes)
    if len(geometries) > _MOST_FEATURES:
        raise SiteError(
            f"{path}: layer {name} has more than {_MOST_FEATURES} features. Export only the areas "
            "to be surveyed."
        )
    found = _geometries(geometries, path)
    if int(shapely.get_num_coordinates(found).sum()) > _MOST_CORNERS:
        raise SiteError(
            f"{path}: layer {name} has more than {_MOST_CORNERS} corners. Simplify its outlines "
            "(QGIS: Simplify, 1 m)."
        )
    if bool(shapely.has_z(found).any()):
        notes.append(f"{path}: heights of its corners are not used")
    names = [str(field) for field in meta["fields"]]
    features = []
    for index, geometry in enumerate(found):
        properties = {n: _plain(c[index]) for n, c in zip(names, columns, strict=True)}
        called = _called(properties)
        place = f"{path}, feature {index + 1}" + (f' "{called}"' if called else "")
        if not np.isfinite(shapely.get_coordinates(geometry)).all():
            raise SiteError(f"{place}: a corner is not a number. Correct it, or export it again.")
        features.append(Feature(place, called, geometry, properties))
    placed = _in_degrees(found, meta["crs"], path, notes)
    features = [replace(one, geometry=g) for one, g in zip(features, placed, strict=True)]
    return Layer(name, tuple(features), tuple(notes))


def _raw(path: str, name: str, notes: list[str]) -> tuple[Any, Any, Any]:
    try:
        with warnings.catch_warnings(record=True) as said:
            warnings.simplefilter("always")
            meta, _, geometries, columns = pyogrio.raw.read(
                path, layer=name, max_features=_MOST_FEATURES + 1
            )
    except _OGR_ERRORS as error:
        raise SiteError(
            f"{path}: layer {name} cannot be read ({_short(error)}). Export it again."
        ) from None
    for text in dict.fromkeys(str(warning.message) for warning in said):
        notes.append(
            f"{path}: a ring is not closed, its last corner is joined to its first"
            if _UNCLOSED in text
            else f"{path}: {_short(text)}"
        )
    return meta, [] if geometries is None else geometries, columns


def _geometries(wkb: Any, path: str) -> np.ndarray:
    try:
        # Coordinates that are no numbers are refused by the name of their feature.
        with np.errstate(invalid="ignore"):
            # A ring left open is closed, which the note says; nothing else is mended.
            return np.asarray(shapely.from_wkb(wkb, on_invalid=_ON_INVALID), dtype=object)
    except (ShapelyError, TypeError, ValueError) as error:
        raise SiteError(
            f"{path}: has a geometry that cannot be read ({_short(error)}). Rings must be "
            "closed and curves straight edges (QGIS: Fix geometries, Segmentize)."
        ) from None


def _in_degrees(found: np.ndarray, crs_text: str | None, path: str, notes: list[str]) -> np.ndarray:
    """Geometries in longitude and latitude of WGS-84. Raises SiteError."""
    if not crs_text:
        raise SiteError(
            f"{path}: names no coordinate system (a Shapefile's is in the .prj beside it). Add it, "
            "or write it with ogr2ogr -a_srs EPSG:…."
        )
    try:
        crs = CRS.from_user_input(crs_text)
    except ProjError as error:
        raise SiteError(
            f"{path}: has a coordinate system that PROJ does not know ({_short(error)}). Reproject "
            "it (ogr2ogr -t_srs EPSG:4326)."
        ) from None
    if crs.to_epsg() == 4326 or crs.is_exact_same("OGC:CRS84"):
        return found
    coordinates = shapely.get_coordinates(found)
    if not len(coordinates):
        return found
    try:
        place = placing(crs.to_2d(), path, _bounds_deg(crs, coordinates), tool="ogr2ogr")
        x, y = coordinates.T
        lon, lat = place.transformer.transform(x, y, direction="INVERSE")
    except (TerrainError, ProjError) as error:
        raise SiteError(_short(error, 600)) from None
    if place.note:
        notes.append(f"{path}: {place.note}")
    return np.asarray(shapely.set_coordinates(shapely.force_2d(found), np.column_stack([lon, lat])))


def _bounds_deg(crs: CRS, coordinates: np.ndarray) -> tuple[float, float, float, float]:
    """West, south, east and north on the file's own datum, roughly."""
    base = crs.geodetic_crs or crs
    lon, lat = Transformer.from_crs(crs, base, always_xy=True).transform(*coordinates.T)
    scale = math.degrees(base.axis_info[0].unit_conversion_factor)
    lon, lat = np.asarray(lon) * scale, np.asarray(lat) * scale
    if not (np.isfinite(lon).all() and np.isfinite(lat).all()):
        return -180.0, -90.0, 180.0, 90.0
    return (
        max(float(lon.min()), -180.0),
        max(float(lat.min()), -90.0),
        min(float(lon.max()), 180.0),
        min(float(lat.max()), 90.0),
    )


def polygon_parts(geometry: BaseGeometry | None) -> Iterator[BaseGeometry]:
    """Polygons and multi-polygons of a geometry, also inside collections, none of them empty."""
    if geometry is None or geometry.is_empty:
        return
    if geometry.geom_type in ("Polygon", "MultiPolygon"):
        yield geometry
    elif geometry.geom_type == "GeometryCollection":
        for part in geometry.geoms:
            yield from polygon_parts(part)


def _called(properties: dict[str, Any]) -> str:
    by_lower = {name.lower(): value for name, value in properties.items()}
    return next((str(by_lower[n])[:60] for n in _NAMES if by_lower.get(n)), "")


def _plain(value: Any) -> Any:
    """Numbers, text and None, whatever numpy made of them."""
    if isinstance(value, np.generic):
        value = value.item() if not isinstance(value, np.datetime64) else str(value)
    return None if isinstance(value, float) and math.isnan(value) else value


def _short(error: object, most: int = 160) -> str:
    text = " ".join(str(error).split()).rstrip(".")
    return text if len(text) <= most else f"{text[: most - 1]}…"
