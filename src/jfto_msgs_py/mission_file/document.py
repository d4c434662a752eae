"""What a mission file holds."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

from jfto_msgs_py.errors import InputError

# MAV_CMD numbers (mavlink.io, common.xml).
FENCE_RETURN, POLYGON_IN, POLYGON_OUT, CIRCLE_IN, CIRCLE_OUT = range(5000, 5005)
FENCE_COMMANDS = frozenset((FENCE_RETURN, POLYGON_IN, POLYGON_OUT, CIRCLE_IN, CIRCLE_OUT))
RALLY = 5100
# Commands whose fourth parameter, a heading, may be left open, and those whose reserved parameters
# QGroundControl leaves open: a vehicle takes 0 for both, and refuses "not a number".
_OPEN_HEADING = frozenset((16, 17, 18, 19, 21, 22, 31, 82, 84, 85, 92))
# Where a vehicle flies to or looks: what is open there would be 0 degrees, or the height of home.
_PLACED = frozenset((16, 17, 18, 19, 31, 82, 195, 201, *FENCE_COMMANDS, RALLY))
_TAKEOFF = 22
_PLACE_NAMES = {4: "latitude", 5: "longitude", 6: "altitude"}
# No frame of MAVLink's: heights of other makes' routes above the ellipsoid.
ABOVE_ELLIPSOID = 900
_OPEN_RESERVED = frozenset((203, 206, 214, 530, 531, 532, 2000, 2001, 2500, 2501))


class MissionTextError(InputError):
    """A mission file cannot be read rightly; names file, item, reason and cure."""


@dataclass(frozen=True)
class FileItem:
    """One item: `params` are the seven of MAVLink, degrees and metres, NaN where left open.

    `place` names file and item, for messages.
    """

    place: str
    command: int
    frame: int
    params: tuple[float, ...]
    current: int = 0
    autocontinue: int = 1
    # Which parameters the file leaves open, also those that are now 0.
    left_open: tuple[bool, ...] = field(init=False, default=())

    def __post_init__(self) -> None:
        """Put 0 where an open parameter means just that. Raises MissionTextError for a place."""
        open_here = set() if self.command in _PLACED else {4, 5, 6}
        if self.command == _TAKEOFF:
            open_here.remove(6)
        for index, name in _PLACE_NAMES.items():
            if index not in open_here and math.isnan(self.params[index]):
                raise MissionTextError(
                    f"{self.place}: the {name} of command {self.command} is left open. Set it."
                )
        if self.command in _OPEN_HEADING:
            open_here.add(3)
        if self.command in _OPEN_RESERVED:
            open_here.update(range(7))
        filled = tuple(
            0.0 if math.isnan(value) and index in open_here else value
            for index, value in enumerate(self.params)
        )
        object.__setattr__(self, "left_open", tuple(map(math.isnan, self.params)))
        object.__setattr__(self, "params", filled)


@dataclass(frozen=True)
class MissionDocument:
    """Items without home, fence and rally points, and `notes` on all that is not taken over.

    `home` is latitude, longitude and metres above sea level (NaN where left open), None where the
    file names none, on the ground there with `home_on_ground`; `home_unnamed_by` is the program
    whose files never name one. `hover_speed_mps` is QGroundControl's.
    """

    items: tuple[FileItem, ...]
    home: tuple[float, float, float] | None
    fence: tuple[FileItem, ...] = ()
    rally: tuple[FileItem, ...] = ()
    parameters: tuple[tuple[str, float], ...] = ()
    notes: tuple[str, ...] = ()
    hover_speed_mps: float | None = None
    home_on_ground: bool = False
    home_unnamed_by: str = ""


def finite(value: Any, what: str, place: str) -> float:
    """A finite number that is no text and no truth value. Raises MissionTextError."""
    if isinstance(value, bool) or not isinstance(value, int | float) or not _is_finite(value):
        raise MissionTextError(
            f"{place}: {what} is {_shown(value)}, must be a number. Correct it, or save the file "
            "again."
        )
    return float(value)


def whole(value: Any, what: str, place: str, low: int = 0, high: int = 65535) -> int:
    """A whole number within bounds. Raises MissionTextError."""
    number = finite(value, what, place)
    if number != int(number) or not low <= number <= high:
        raise MissionTextError(
            f"{place}: {what} is {_shown(value)}, must be a whole number from {low} to {high}. "
            "Correct it, or save the file again."
        )
    return int(number)


def _is_finite(value: float) -> bool:
    # Whole numbers of JSON have no limit.
    return abs(value) < 1e300 and math.isfinite(value)


def _shown(value: Any) -> str:
    text = repr(value)
    return text if len(text) <= 40 else f"{text[:37]}..."
