"""Places that a file gives one by one: where, how high above what, and where the camera looks."""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import Enum
from typing import Any

from jfto_msgs_py.mission_file.document import MissionTextError


class Above(Enum):
    """What a height is measured from."""

    # A file that says nothing: sea level, or the origin of local metres.
    UNSAID = ""
    SEA_LEVEL = "amsl"
    GROUND = "agl"
    HOME = "home"
    ELLIPSOID = "ellipsoid"
    # Laid on the ground, without a height of its own.
    CLAMPED = "clamped"


@dataclass(frozen=True)
class FilePoint:
    """One place: `at` is latitude and longitude in degrees, or metres east and north if `local`.

    `place` names file and line or item, for messages; yaw and pitch as in `Waypoint`.
    """

    place: str
    at: tuple[float, float]
    height_m: float
    above: Above
    yaw_deg: float = 0.0
    pitch_deg: float = -90.0
    local: bool = False


@dataclass(frozen=True)
class PointDocument:
    """The places of a file in its order, and `notes`, a line on each kind of thing not used."""

    points: tuple[FilePoint, ...]
    notes: tuple[str, ...] = ()


def number(value: Any, what: str, place: str) -> float:
    """A finite number, from text or JSON. Raises MissionTextError."""
    # Python's own reading takes "1_000" for a thousand, and digits of all scripts.
    plain = not isinstance(value, str) or (value.isascii() and "_" not in value)
    try:
        result = float(value) if plain else math.nan
    except (TypeError, ValueError, OverflowError):
        result = math.nan
    if isinstance(value, bool) or not math.isfinite(result):
        shown = repr(value) if len(repr(value)) <= 40 else f"{repr(value)[:37]}..."
        raise MissionTextError(
            f"{place}: {what} is {shown}, must be a number with a decimal point."
        )
    return result
