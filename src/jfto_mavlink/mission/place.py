"""Distances between places given as latitude, longitude (degrees) and height (metres)."""

from __future__ import annotations

import math

Place = tuple[float, float, float]
Offset = tuple[float, float, float]

_EQUATOR_M = 6_378_137.0
_ECCENTRICITY2 = 0.00669437999014


def offset_m(origin: Place, place: Place) -> Offset:
    """East, north and up from one place to another nearby; errors below 1 mm within 1 km."""
    lat = math.radians(origin[0])
    root = 1.0 - _ECCENTRICITY2 * math.sin(lat) ** 2
    height = origin[2]
    north_radius = _EQUATOR_M * (1.0 - _ECCENTRICITY2) / root**1.5 + height
    east_radius = _EQUATOR_M / math.sqrt(root) + height
    turn = (place[1] - origin[1] + 180.0) % 360.0 - 180.0
    east = math.radians(turn) * east_radius * math.cos(math.radians((origin[0] + place[0]) / 2))
    north = math.radians(place[0] - origin[0]) * north_radius
    return east, north, place[2] - origin[2]


def distance_m(a: Place, b: Place) -> float:
    """Straight distance between two places nearby."""
    return math.hypot(*offset_m(a, b))


def closest_m(start: Place, end: Place, place: Place) -> float:
    """Least distance to a place on the straight way from start to end."""
    sx, sy, sz = offset_m(place, start)
    ex, ey, ez = offset_m(place, end)
    dx, dy, dz = ex - sx, ey - sy, ez - sz
    square = dx * dx + dy * dy + dz * dz
    t = 0.0 if square == 0 else min(max(-(sx * dx + sy * dy + sz * dz) / square, 0.0), 1.0)
    return math.hypot(sx + t * dx, sy + t * dy, sz + t * dz)
