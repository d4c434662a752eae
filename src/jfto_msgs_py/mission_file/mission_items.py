"""Items of a MAVLink mission that stand for what routes of other makes say."""

from __future__ import annotations

import math
from collections.abc import Callable

from jfto_msgs_py.mission_file.document import ABOVE_ELLIPSOID, FileItem

__all__ = ["ABOVE_ELLIPSOID"]

Value = Callable[[str], float | None]

ABOVE_SEA_LEVEL, ABOVE_HOME, ABOVE_GROUND = 0, 3, 10
_NO_PLACE = 2
_WAYPOINT, _YAW, _SPEED, _MOUNT, _ROI, _ROI_NONE = 16, 115, 178, 205, 195, 197
_SHOOT, _DISTANCE, _INTERVAL = 203, 206, 214
AIMING = (_YAW, _MOUNT)


def _item(place: str, command: int, *params: float, frame: int = _NO_PLACE) -> FileItem:
    return FileItem(place, command, frame, (*params, *[0.0] * (7 - len(params))))


def waypoint(place: str, frame: int, where: tuple[float, float, float]) -> FileItem:
    """Fly to latitude, longitude and height in a frame."""
    return _item(place, _WAYPOINT, 0.0, 0.0, 0.0, 0.0, *where, frame=frame)


def heading(place: str, angle_deg: float) -> FileItem:
    """Turn to a heading, degrees clockwise from north."""
    return _item(place, _YAW, angle_deg % 360.0)


def pitch(place: str, angle_deg: float) -> FileItem:
    """Tilt the camera: 0 to the horizon, -90 straight down."""
    return _item(place, _MOUNT, angle_deg)


def look_at(place: str, frame: int, where: tuple[float, float, float]) -> FileItem:
    """Look at a place from now on."""
    return _item(place, _ROI, 0.0, 0.0, 0.0, 0.0, *where, frame=frame)


def look_ahead(place: str) -> FileItem:
    """Look at no place any more."""
    return _item(place, _ROI_NONE)


def speed(place: str, mps: float) -> FileItem:
    """Fly at a speed over ground."""
    return _item(place, _SPEED, 1.0, mps)


def shoot(place: str) -> FileItem:
    """One photo from here."""
    return _item(place, _SHOOT, 0.0, 0.0, 0.0, 0.0, 1.0)


def every_metres(place: str, distance_m: float) -> FileItem:
    """A photo here, and one each distance from here."""
    return _item(place, _DISTANCE, distance_m, 0.0, 1.0)


def every_seconds(place: str, interval_s: float) -> FileItem:
    """A photo each interval from here."""
    return _item(place, _INTERVAL, 1000.0 * interval_s)


def no_more(place: str) -> FileItem:
    """No photos by distance or time any more."""
    return _item(place, _DISTANCE)


def course(start: tuple[float, float], end: tuple[float, float]) -> float:
    """Heading in degrees from one latitude and longitude to another nearby."""
    north = end[0] - start[0]
    turn = (end[1] - start[1] + 180.0) % 360.0 - 180.0
    east = turn * math.cos(math.radians((start[0] + end[0]) / 2))
    return math.degrees(math.atan2(east, north)) % 360.0
