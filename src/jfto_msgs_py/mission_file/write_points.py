"""Writes waypoints as a table or as GeoJSON."""

from __future__ import annotations

import csv
import io
import json
import re
from typing import Any

from jfto_msgs_py.mission_file.geo_plan import GeoPlan, GeoRoute, GeoStop
from jfto_msgs_py.mission_file.points import Above

_SEA_LEVEL = Above.SEA_LEVEL.value
# What tears lines apart, or makes a file no text.
_CONTROL = re.compile("[\x00-\x1f\x7f-\x9f]")


def write_csv(plan: GeoPlan) -> bytes:
    """One row per waypoint, in the order of routes; what `height_reference` says counts."""
    rows = [_row(route, k, stop) for route in plan.routes for k, stop in enumerate(route.stops, 1)]
    names = list(dict.fromkeys(name for row in rows for name in row))
    text = io.StringIO()
    writer = csv.DictWriter(text, names, lineterminator="\n", restval="")
    writer.writeheader()
    writer.writerows(rows)
    return text.getvalue().encode()


def write_geojson(plan: GeoPlan) -> bytes:
    """One point [lon, lat, alt] per waypoint, all else as properties."""
    features = []
    for route in plan.routes:
        for order, stop in enumerate(route.stops, start=1):
            row = _row(route, order, stop)
            at = [float(row.pop(name)) for name in ("lon", "lat", "alt")]
            geometry = {"type": "Point", "coordinates": at}
            features.append({"type": "Feature", "geometry": geometry, "properties": row})
    collection = {"type": "FeatureCollection", "features": features}
    return (json.dumps(collection, indent=1, ensure_ascii=False) + "\n").encode()


def _row(route: GeoRoute, order: int, stop: GeoStop) -> dict[str, Any]:
    lat, lon, alt = stop.at
    row: dict[str, Any] = {"id": stop.number}
    if route.uav:
        row |= {"uav": _CONTROL.sub(" ", route.uav), "order": order}
    row |= {
        "lat": round(lat, 9),
        "lon": round(lon, 9),
        "alt": round(alt, 3),
        "height_reference": _SEA_LEVEL,
        "yaw_deg": round(stop.yaw_deg, 6),
        "pitch_deg": round(stop.pitch_deg, 6),
    }
    if stop.above_ground_m is not None:
        row["agl_m"] = round(stop.above_ground_m, 3)
    if route.home is not None:
        row["above_home_m"] = round(alt - route.home[2], 3)
    if stop.arrival_s is not None:
        row["arrival_s"] = round(stop.arrival_s, 3)
    if not stop.photo:
        row["take_photo"] = False
    return row
