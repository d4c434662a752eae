"""Metres north and east of home, and back, in the autopilot's own approximation.

One unit of 1e-7 degree of latitude is 0.011131884502145034 m, and a degree of longitude shrinks
with the cosine of the mean latitude. Good to centimetres over the kilometres a copter flies.
"""

from __future__ import annotations

import math

METRES_PER_UNIT = 0.011131884502145034
UNITS_PER_DEGREE = 1e7
LOCATION_ALT_MAX_M = 83000.0  # what the autopilot's locations can hold


def wrap_longitude(units: int) -> int:
    """Longitude in 1e-7 degree wrapped into +-180 degrees."""
    return (units + 1_800_000_000) % 3_600_000_000 - 1_800_000_000


def offset_m(from_lat: int, from_lon: int, to_lat: int, to_lon: int) -> tuple[float, float]:
    """(east, north) metres from one position to another, all in 1e-7 degree."""
    mean = math.radians((from_lat + to_lat) * 0.5 / UNITS_PER_DEGREE)
    shrink = max(math.cos(mean), 0.01)
    north = (to_lat - from_lat) * METRES_PER_UNIT
    east = wrap_longitude(to_lon - from_lon) * METRES_PER_UNIT * shrink
    return east, north


def move(lat: int, lon: int, east_m: float, north_m: float) -> tuple[int, int]:
    """Position (1e-7 degree) that lies (east, north) metres from another."""
    north_units = north_m / METRES_PER_UNIT
    mean = math.radians((lat + 0.5 * north_units) / UNITS_PER_DEGREE)
    shrink = max(math.cos(mean), 0.01)
    to_lat = round(lat + north_units)
    to_lon = round(lon + east_m / (METRES_PER_UNIT * shrink))
    return to_lat, wrap_longitude(to_lon)


def wrap_360(angle_deg: float) -> float:
    """Angle in 0..360."""
    return angle_deg % 360.0


def wrap_180(angle_deg: float) -> float:
    """Angle in -180..180."""
    return (angle_deg + 180.0) % 360.0 - 180.0
