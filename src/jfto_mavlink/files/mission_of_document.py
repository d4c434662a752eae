"""From what a mission file says to the items that travel to a vehicle."""

from __future__ import annotations

import math

from jfto_mavlink.dialect import mavlink
from jfto_mavlink.errors import MissionError, MissionFileError
from jfto_mavlink.mission.fence import fence_from_items
from jfto_mavlink.protocol.item import DEGREE_1E7, FRAME_ABSOLUTE, Item, Mission, at
from jfto_msgs_py.mission_file import FileItem, MissionDocument

_INT32 = 2**31
_FLOAT32 = 3.4e38
_TERRAIN_FRAMES = (10, 11)
_HIGHEST_M = 100_000.0


def mission_of_document(document: MissionDocument, name: str) -> Mission:
    """The mission of a file; raises MissionFileError for what an item cannot carry."""
    items = tuple(map(_item, document.items))
    notes = list(document.notes)
    over_terrain = sum(item.frame in _TERRAIN_FRAMES and item.is_nav for item in items)
    if over_terrain:
        notes.append(
            f"{name}: {over_terrain} items are above the terrain (frames 10, 11): the vehicle "
            "must have the terrain's data, else it descends"
        )
    notes += [f"{entry.place}: {said}" for entry in document.items if (said := _open_place(entry))]
    if items:
        items = (_home(document, items, notes, name), *items)
    fence, rally = (tuple(map(_item, part)) for part in (document.fence, document.rally))
    for entry, item in zip(document.rally, rally, strict=True):
        if abs(item.lat_deg) > 90 or abs(item.lon_deg) > 180:
            raise MissionFileError(
                302, f"{entry.place}: {item.lat_deg}, {item.lon_deg} is not on Earth. Correct it."
            )
    try:
        fence_from_items(fence)
    except MissionError as error:
        reason = str(error).rpartition(" [MAV-")[0]
        raise MissionFileError(302, f"{name}: {reason} Draw it again.") from None
    return Mission(items, fence, rally, document.parameters, tuple(notes))


def _home(document: MissionDocument, items: tuple[Item, ...], notes: list[str], name: str) -> Item:
    """Item 0. Vehicles put their own there; without one in the file, the first place stands in."""
    if document.home is not None:
        lat, lon, height = document.home
        if math.isnan(height):
            notes.append(f"{name}: the altitude of home is left open, 0 m is written")
        height = 0.0 if math.isnan(height) else height
        if abs(height) > _HIGHEST_M:
            raise MissionFileError(
                302, f"{name}: the altitude of home is {height:g} m, which is not on Earth. Set it."
            )
        return at(mavlink.MAV_CMD_NAV_WAYPOINT, FRAME_ABSOLUTE, lat, lon, height)
    placed = (item for item in items if item.has_position and (item.x or item.y))
    places = (item for item in placed if abs(item.lat_deg) <= 90 and abs(item.lon_deg) <= 180)
    first = next(places, Item(mavlink.MAV_CMD_NAV_WAYPOINT))
    notes.append(f"{name}: names no home; the place of its first item is written, at 0 m")
    return at(mavlink.MAV_CMD_NAV_WAYPOINT, FRAME_ABSOLUTE, first.lat_deg, first.lon_deg, 0.0)


def _open_place(entry: FileItem) -> str:
    """What of a place the file leaves open, for which 0 is written: as it is then and there."""
    if not Item(entry.command, entry.frame).has_position:
        return ""
    names = ("latitude", "longitude", "altitude")
    left = [name for name, is_open in zip(names, entry.left_open[4:], strict=True) if is_open]
    if not left:
        return ""
    return (
        f"the {' and '.join(left)} of command {entry.command} left open: 0 is written, where it is"
    )


def _item(entry: FileItem) -> Item:
    first, second, third, fourth, x, y, z = entry.params
    scale = DEGREE_1E7 if Item(entry.command, entry.frame).has_position else 1
    whole = tuple(round(value * scale) for value in (x, y))
    names = ("latitude", "longitude") if scale > 1 else ("parameter 5", "parameter 6")
    for name, value, rounded in zip(names, (x, y), whole, strict=True):
        if not -_INT32 <= rounded < _INT32 or (scale == 1 and rounded != value):
            raise MissionFileError(
                302,
                f"{entry.place}: {name} of command {entry.command} is {value:g}, which an item "
                "cannot carry: degrees, or a whole number. Correct it.",
            )
    if any(abs(value) > _FLOAT32 for value in entry.params):
        raise MissionFileError(
            302,
            f"{entry.place}: holds a number too large for an item of a mission. Correct it.",
        )
    return Item(
        entry.command,
        entry.frame,
        (first, second, third, fourth),
        whole[0],
        whole[1],
        z,
        entry.current,
        entry.autocontinue,
    )
