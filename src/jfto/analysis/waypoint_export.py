"""Waypoints as files for maps and for `waypoints.source: file`."""

from __future__ import annotations

import csv
import io
import json
from pathlib import Path

import numpy as np

from jfto.planning.survey import Survey
from jfto_msgs_py.errors import InputError
from jfto_msgs_py.write_file import write_file

_SUFFIXES = (".csv", ".geojson")


def check_suffix(path: Path) -> None:
    """Raise InputError unless waypoints can be written in the format that the name asks for."""
    if path.suffix.lower() not in _SUFFIXES:
        raise InputError(f"{path}: is no known format. Name it .csv or .geojson.")


def write_waypoints(found: Survey, path: Path) -> None:
    """Write latitude, longitude, altitude and view of every waypoint; raises InputError."""
    check_suffix(path)
    positions = np.array([waypoint.position_m for waypoint in found.waypoints]).reshape(-1, 3)
    lat, lon, alt = found.dem.to_geodetic(positions)
    rows = [
        (waypoint, f"{north:.8f}", f"{east:.8f}", f"{up:.3f}")
        for waypoint, north, east, up in zip(found.waypoints, lat, lon, alt, strict=True)
    ]
    if path.suffix.lower() == ".csv":
        table = io.StringIO()
        writer = csv.writer(table, lineterminator="\n")
        writer.writerow(["id", "lat", "lon", "alt", "yaw_deg", "pitch_deg"])
        for waypoint, north, east, up in rows:
            view = (f"{waypoint.yaw_deg:.3f}", f"{waypoint.pitch_deg:.3f}")
            writer.writerow([waypoint.id, north, east, up, *view])
        write_file(path, table.getvalue())
        return
    features = [
        {
            "type": "Feature",
            "geometry": {"type": "Point", "coordinates": [float(east), float(north), float(up)]},
            "properties": {
                "id": waypoint.id,
                "yaw_deg": round(waypoint.yaw_deg, 3),
                "pitch_deg": round(waypoint.pitch_deg, 3),
            },
        }
        for waypoint, north, east, up in rows
    ]
    collection = {"type": "FeatureCollection", "features": features}
    write_file(path, json.dumps(collection, indent=1) + "\n")
