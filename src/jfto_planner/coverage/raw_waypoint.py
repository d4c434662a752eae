"""A waypoint just read, which still knows where it stood in its file."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from jfto_msgs_py.errors import TerrainError, WaypointError
from jfto_msgs_py.records.plan import Vector
from jfto_world.terrain import Dem


@dataclass(frozen=True)
class RawWaypoint:
    """`place` names line or item, for messages; yaw and pitch as in `Waypoint`."""

    place: str
    position_m: Vector
    yaw_deg: float = 0.0
    pitch_deg: float = -90.0


def number(value: Any, what: str, place: str) -> float:
    """A finite number, from text or JSON. Raises WaypointError."""
    # Python's own reading takes "1_000" for a thousand, and digits of all scripts.
    plain = not isinstance(value, str) or (value.isascii() and "_" not in value)
    try:
        result = float(value) if plain else math.nan
    except (TypeError, ValueError, OverflowError):
        result = math.nan
    if isinstance(value, bool) or not math.isfinite(result):
        shown = repr(value) if len(repr(value)) <= 40 else f"{repr(value)[:37]}..."
        raise WaypointError(f"{place}: {what} is {shown}, must be a number with a decimal point.")
    return result


def from_geodetic(
    dem: Dem, lat_deg: float, lon_deg: float, height_m: float, above_ground: bool, place: str
) -> Vector:
    """ENU position of a latitude, longitude and altitude or height above ground."""
    if not (-90 <= lat_deg <= 90 and -180 <= lon_deg <= 180):
        raise WaypointError(
            f"{place}: ({lat_deg}, {lon_deg}) is not a latitude and longitude in degrees. "
            "Check that they are not exchanged."
        )
    x, y, z = (
        float(v)
        for v in dem.to_enu(lat_deg, lon_deg, dem.origin.alt_m if above_ground else height_m)
    )
    return (x, y, ground_height(dem, x, y, place) + height_m) if above_ground else (x, y, z)


def ground_height(dem: Dem, x_m: float, y_m: float, place: str) -> float:
    """Ground height at a point. Raises WaypointError outside of the terrain."""
    try:
        return float(dem.height(x_m, y_m))
    except TerrainError as error:
        raise WaypointError(f"{place}: {error}") from error
