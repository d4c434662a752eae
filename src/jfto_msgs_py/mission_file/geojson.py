"""Waypoints as GeoJSON points (RFC 7946)."""

from __future__ import annotations

import json
from typing import Any

from jfto_msgs_py.mission_file.csv_points import reference
from jfto_msgs_py.mission_file.document import MissionTextError
from jfto_msgs_py.mission_file.other_names import ANGLES, PHOTO, angles, not_used, switched_off
from jfto_msgs_py.mission_file.points import Above, FilePoint, PointDocument, number

_REFERENCE = "height_reference"
_SAID_NOWHERE = {"agl_m", _REFERENCE, *PHOTO}
_AREAS = ("Polygon", "MultiPolygon")


def read_geojson(text: str, source: str) -> PointDocument:
    """Points of a FeatureCollection, Feature or geometry, [lon, lat, alt]. Raises MissionTextError.

    Properties `yaw_deg` and `pitch_deg` are used, also under the names of other programs; `agl_m`
    takes the place of the altitude, `height_reference` says what that is above, and a false
    `take_photo` makes a point none.
    """
    document = _load_json(text, source)
    if not isinstance(document, dict):
        raise MissionTextError(f"{source}: is not a GeoJSON object. Export it as GeoJSON points.")
    if document.get("fileType") == "Plan":
        raise MissionTextError(f"{source}: is a QGroundControl plan. Name it .plan.")
    _check_crs(document, source)
    if document.get("type") == "FeatureCollection":
        features = document.get("features")
        if not isinstance(features, list):
            raise MissionTextError(f"{source}: features is missing. Export it as GeoJSON points.")
        places = [(f"{source}, feature {index}", item) for index, item in enumerate(features)]
    else:
        places = [(source, document)]
    reader = _Reader()
    points = [point for place, feature in places for point in reader.feature(feature, place)]
    notes = not_used(source, reader.names, ANGLES | _SAID_NOWHERE)
    if reader.left_out:
        notes.append(f"{source}: {reader.left_out} points with take_photo false are left out")
    return PointDocument(tuple(points), tuple(notes))


def _load_json(text: str, source: str) -> Any:
    """Parsed JSON. Raises MissionTextError with line and column."""

    def unique(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
        if len(found := dict(pairs)) != len(pairs):
            raise MissionTextError(f"{source}: gives a key twice in one object. Export it again.")
        return found

    try:
        return json.loads(text, object_pairs_hook=unique)
    except json.JSONDecodeError as error:
        raise MissionTextError(
            f"{source}, line {error.lineno}, column {error.colno}: is not JSON ({error.msg}). "
            "The file is damaged or cut short; export it again."
        ) from error
    except (RecursionError, ValueError) as error:
        reason = "nested too deeply" if isinstance(error, RecursionError) else str(error)[:80]
        raise MissionTextError(f"{source}: cannot be read: {reason}. Export it again.") from error


def _check_crs(document: dict[str, Any], source: str) -> None:
    """Old GeoJSON may name a coordinate system; only degrees of WGS-84 are read."""
    crs = document.get("crs")
    if crs is None:
        return
    properties = crs.get("properties") if isinstance(crs, dict) else None
    name = str(properties.get("name")) if isinstance(properties, dict) else str(crs)
    if not name.replace("::", ":").endswith(("CRS84", "CRS84h", "EPSG:4326", "EPSG:4979")):
        raise MissionTextError(
            f"{source}: its coordinates are in {name[:60]}, not in longitude and latitude of "
            "WGS-84. Reproject it (ogr2ogr -t_srs EPSG:4326)."
        )


class _Reader:
    """Reads features, and keeps the names of their properties."""

    def __init__(self) -> None:
        self.names: set[str] = set()
        self.left_out = 0

    def feature(self, feature: Any, place: str) -> list[FilePoint]:
        if not isinstance(feature, dict):
            raise MissionTextError(f"{place}: is not a GeoJSON feature. Export it as points.")
        is_feature = feature.get("type") == "Feature"
        geometry = feature.get("geometry") if is_feature else feature
        properties = (feature.get("properties") or {}) if is_feature else {}
        if not isinstance(geometry, dict) or not isinstance(properties, dict):
            raise MissionTextError(f"{place}: has no geometry. Export it as points.")
        properties = {str(name).lower(): value for name, value in properties.items()}
        kind, coordinates = geometry.get("type"), geometry.get("coordinates")
        if kind == "Point":
            points = [(place, coordinates)]
        elif kind == "MultiPoint" and isinstance(coordinates, list):
            points = [(f"{place}, point {k}", item) for k, item in enumerate(coordinates)]
        elif kind in _AREAS:
            raise MissionTextError(
                f"{place}: is a {kind!r}, an area; waypoints are of type Point. To photograph it, "
                "set waypoints.source to coverage and area.file to this file."
            )
        else:
            raise MissionTextError(
                f"{place}: is a {str(kind)[:40]!r}, waypoints are of type Point. Export vertices "
                "as points."
            )
        self.names.update(properties)
        if switched_off(properties):
            self.left_out += len(points)
            return []
        return [self._point(item, properties, where) for where, item in points]

    def _point(self, coordinates: Any, properties: dict[str, Any], place: str) -> FilePoint:
        if not isinstance(coordinates, list) or len(coordinates) < 2:
            raise MissionTextError(
                f"{place}: coordinates are {str(coordinates)[:60]!r}, must be [lon, lat, alt]."
            )
        if len(coordinates) > 3:
            self.names.add("a fourth coordinate")
        lon_deg = number(coordinates[0], "longitude", place)
        lat_deg = number(coordinates[1], "latitude", place)
        told, above = properties.get(_REFERENCE), Above.UNSAID
        if "agl_m" in properties and not told:
            above, height_m = Above.GROUND, number(properties["agl_m"], "agl_m", place)
        elif len(coordinates) > 2:
            height_m = number(coordinates[2], "altitude", place)
        else:
            raise MissionTextError(
                f"{place}: has no altitude. Write [lon, lat, alt], or the property agl_m for a "
                "height above ground."
            )
        if told:
            above = reference(str(told), _REFERENCE, place)
        return FilePoint(place, (lat_deg, lon_deg), height_m, above, *angles(properties, place))
