"""Waypoints as GeoJSON points (RFC 7946)."""

from __future__ import annotations

import json
from typing import Any

from jfto_msgs_py.errors import WaypointError
from jfto_planner.coverage.raw_waypoint import RawWaypoint, from_geodetic, number
from jfto_world.terrain import Dem


def read_geojson(text: str, source: str, dem: Dem) -> list[RawWaypoint]:
    """Points of a FeatureCollection, Feature or geometry, [lon, lat, alt]. Raises WaypointError.

    Properties `yaw_deg` and `pitch_deg` are used; `agl_m` takes the place of the altitude.
    """
    document = load_json(text, source)
    if not isinstance(document, dict):
        raise WaypointError(f"{source}: is not a GeoJSON object. Export it as GeoJSON points.")
    if document.get("type") == "FeatureCollection":
        features = document.get("features")
        if not isinstance(features, list):
            raise WaypointError(f"{source}: features is missing. Export it as GeoJSON points.")
        places = [(f"{source}, feature {index}", item) for index, item in enumerate(features)]
    else:
        places = [(source, document)]
    result: list[RawWaypoint] = []
    for place, feature in places:
        result.extend(_feature(feature, place, dem))
    return result


def load_json(text: str, source: str) -> Any:
    """Parsed JSON. Raises WaypointError with line and column."""
    try:
        return json.loads(text)
    except json.JSONDecodeError as error:
        raise WaypointError(
            f"{source}, line {error.lineno}, column {error.colno}: is not JSON ({error.msg}). "
            "The file is damaged or cut short; export it again."
        ) from error
    except RecursionError as error:
        raise WaypointError(f"{source}: is nested too deeply. Export it again.") from error


def _feature(feature: Any, place: str, dem: Dem) -> list[RawWaypoint]:
    if not isinstance(feature, dict):
        raise WaypointError(f"{place}: is not a GeoJSON feature. Export it as points.")
    is_feature = feature.get("type") == "Feature"
    geometry = feature.get("geometry") if is_feature else feature
    properties = (feature.get("properties") or {}) if is_feature else {}
    if not isinstance(geometry, dict) or not isinstance(properties, dict):
        raise WaypointError(f"{place}: has no geometry. Export it as points.")
    kind, coordinates = geometry.get("type"), geometry.get("coordinates")
    if kind == "Point":
        return [_point(coordinates, properties, place, dem)]
    if kind == "MultiPoint" and isinstance(coordinates, list):
        return [
            _point(item, properties, f"{place}, point {index}", dem)
            for index, item in enumerate(coordinates)
        ]
    raise WaypointError(
        f"{place}: is a {kind!r}, waypoints are of type Point. Export vertices as points."
    )


def _point(coordinates: Any, properties: dict[str, Any], place: str, dem: Dem) -> RawWaypoint:
    if not isinstance(coordinates, list) or len(coordinates) < 2:
        raise WaypointError(f"{place}: coordinates are {coordinates!r}, must be [lon, lat, alt].")
    lon_deg = number(coordinates[0], "longitude", place)
    lat_deg = number(coordinates[1], "latitude", place)
    above_ground = "agl_m" in properties
    if above_ground:
        height_m = number(properties["agl_m"], "agl_m", place)
    elif len(coordinates) > 2:
        height_m = number(coordinates[2], "altitude", place)
    else:
        raise WaypointError(
            f"{place}: has no altitude. Write [lon, lat, alt], or the property agl_m for a height "
            "above ground."
        )
    return RawWaypoint(
        place,
        from_geodetic(dem, lat_deg, lon_deg, height_m, above_ground, place),
        number(properties.get("yaw_deg", 0.0), "yaw_deg", place) % 360.0,
        number(properties.get("pitch_deg", -90.0), "pitch_deg", place),
    )
