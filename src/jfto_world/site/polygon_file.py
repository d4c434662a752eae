"""Polygons of a file of any of the kinds that people draw areas in."""

from __future__ import annotations

import zipfile
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path

from jfto_msgs_py.errors import SiteError
from jfto_msgs_py.files import read_data
from jfto_msgs_py.mission_file import PLAN_SUFFIX, MissionTextError
from jfto_msgs_py.mission_file.survey_polygons import read_survey_polygons
from jfto_world.site.rings import geo_polygons, ring_polygon
from jfto_world.site.site_file import SiteFile, SiteShape
from jfto_world.site.vector_file import Feature, Layer, layer_names, polygon_parts, read_layer

_VECTORS = (".kml", ".kmz", ".geojson", ".json", ".shp", ".zip", ".gpkg")
_KINDS = "KML, KMZ, GeoJSON, Shapefile (.shp or zipped), GeoPackage or QGroundControl .plan"
_LARGEST_BYTES, _LARGEST_UNPACKED = 64 * 2**20, 256 * 2**20
# Entities are how a small XML file becomes a huge one; no program that draws areas writes them.
_XML_BOMB = (b"<!DOCTYPE", b"<!ENTITY")
_PLAIN = {"Point": "point", "MultiPoint": "group of points", "LineString": "line",
          "MultiLineString": "group of lines", "GeometryCollection": "collection"}  # fmt: skip


@dataclass(frozen=True)
class SiteKeys:
    """The scenario keys that a file and its layer were named by, for messages."""

    file: str = "area.file"
    layer: str = "area.layer"


def read_site(path: Path, layer: str = "", keys: SiteKeys | None = None) -> SiteFile:
    """Polygons (and points) of a file, checked, in degrees of WGS-84.

    Parameters
    ----------
    path
        A KML, KMZ, GeoJSON, Shapefile (also zipped), GeoPackage or QGroundControl `.plan` file, of
        which the polygons of its surveys are taken.
    layer
        The layer to read, a folder in KML; "": the one that has polygons.
    keys
        What messages call the two; None: area.file and area.layer.

    Returns
    -------
    SiteFile
        At least one shape or point.

    Raises
    ------
    SiteError
        Names the key, the file, the reason and the cure.
    """
    keys = keys or SiteKeys()
    try:
        found = _read(path, layer, keys)
    except (SiteError, MissionTextError) as error:
        raise SiteError(f"{keys.file}: {error}") from None
    return found


def _read(path: Path, layer: str, keys: SiteKeys) -> SiteFile:
    suffix = path.suffix.lower()
    if suffix == PLAN_SUFFIX:
        return _of_plan(path)
    if suffix not in _VECTORS:
        raise SiteError(f"{path}: is of no known kind of file. Use {_KINDS}.")
    data = read_data(path, SiteError, "area", _LARGEST_BYTES)
    if not data.strip():
        raise SiteError(f"{path}: is empty. Export the area again.")
    _check_packed(data, path)
    if suffix in (".kml", ".kmz"):
        _check_xml(data, path)
    chosen = _layer(path, layer, keys)
    shapes, points, others = [], [], Counter[str]()
    for feature in chosen.features:
        polygons = tuple(
            polygon
            for part in polygon_parts(feature.geometry)
            for polygon in geo_polygons(part, feature.place)
        )
        if polygons:
            shapes.append(
                SiteShape(feature.place, feature.name, polygons, None, feature.properties)
            )
        elif (point := _point(feature)) is not None:
            points.append(point)
        others.update(_others(feature, bool(polygons)))
    if not shapes and not points:
        raise SiteError(_nothing(path, chosen, others))
    notes = list(chosen.notes)
    if shapes and others:
        notes.append(f"{path}: {_listed(others)} not used: no polygon")
    return SiteFile(tuple(shapes), tuple(points), tuple(notes))


def _of_plan(path: Path) -> SiteFile:
    surveys = read_survey_polygons(path)
    if not surveys:
        raise SiteError(
            f"{path}: has no survey, so no area. Draw one in QGroundControl (Pattern › Survey); "
            "its fence is read by fence.file."
        )
    return SiteFile(
        tuple(
            SiteShape(s.place, f"{s.kind} {k}", ring_polygon(s.corners_deg, s.place))
            for k, s in enumerate(surveys, start=1)
        )
    )


def _layer(path: Path, wanted: str, keys: SiteKeys) -> Layer:
    """The layer asked for, or the only one with polygons."""
    names = layer_names(str(path))
    if wanted and wanted not in names:
        raise SiteError(
            f"{path}: has no layer {wanted!r} ({keys.layer}). It has {', '.join(names) or 'none'}."
        )
    if not names:
        raise SiteError(f"{path}: has no layer. Export the area again.")
    if wanted or len(names) == 1:
        return read_layer(str(path), wanted or names[0])
    layers = [read_layer(str(path), name) for name in names]
    filled = [one for one in layers if _has_polygons(one)]
    if len(filled) > 1:
        listed = ", ".join(one.name for one in filled)
        raise SiteError(
            f"{path}: has areas in {len(filled)} layers: {listed}. Name one with {keys.layer}."
        )
    return filled[0] if filled else max(layers, key=lambda one: len(one.features))


def _has_polygons(layer: Layer) -> bool:
    return any(True for feature in layer.features for _ in polygon_parts(feature.geometry))


def _point(feature: Feature) -> SiteShape | None:
    geometry = feature.geometry
    if geometry is None or geometry.geom_type != "Point" or geometry.is_empty:
        return None
    lat_lon = (float(geometry.y), float(geometry.x))
    return SiteShape(feature.place, feature.name, (), lat_lon, feature.properties)


def _others(feature: Feature, has_polygons: bool) -> Iterator[str]:
    """What a feature is besides polygons, in words."""
    geometry = feature.geometry
    if geometry is None or geometry.is_empty:
        kind = "" if geometry is None else f" {geometry.geom_type}"
        yield f"empty{kind}" if kind else "feature without geometry"
    elif not has_polygons:
        kind = geometry.geom_type
        closed = kind == "LineString" and geometry.is_closed
        yield "closed line" if closed else _PLAIN.get(kind, kind)


def _nothing(path: Path, layer: Layer, others: Counter[str]) -> str:
    if not layer.features:
        return f"{path}: layer {layer.name} has no feature. Draw the area in it, and save."
    cure = "Draw the area as a polygon."
    if others["closed line"]:
        cure = "Make polygons of closed lines (QGIS: Lines to polygons)."
    return f"{path}: has no polygon, but {_listed(others)}. {cure}"


def _listed(others: Counter[str]) -> str:
    return ", ".join(f"{count} × {kind}" for kind, count in others.items())


def _check_packed(data: bytes, path: Path) -> None:
    """Refuse archives that unpack to more than any area needs."""
    if not data.startswith(b"PK"):
        return
    try:
        with zipfile.ZipFile(BytesIO(data)) as archive:
            size = sum(entry.file_size for entry in archive.infolist())
    except zipfile.BadZipFile as error:
        raise SiteError(f"{path}: is a damaged archive ({error}). Pack it again.") from None
    if size > _LARGEST_UNPACKED:
        raise SiteError(
            f"{path}: unpacks to {size / 1e6:.0f} MB, more than any area needs "
            f"({_LARGEST_UNPACKED / 1e6:.0f} MB). Is it the right file?"
        )


def _check_xml(data: bytes, path: Path) -> None:
    texts = [data]
    if data.startswith(b"PK"):
        with zipfile.ZipFile(BytesIO(data)) as archive:
            texts = [archive.read(n) for n in archive.namelist() if n.lower().endswith(".kml")]
        if not texts:
            raise SiteError(f"{path}: holds no .kml. Export it again from Google Earth.")
    if any(mark in text.upper() for text in texts for mark in _XML_BOMB):
        raise SiteError(
            f"{path}: declares XML entities or a document type, which no KML needs. Export it "
            "again."
        )
