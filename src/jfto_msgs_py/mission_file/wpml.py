"""DJI waylines (WPML) as the items of a mission that does the same.

Format: the DJI WPML pages of the Cloud API documentation. `waylines.wpml` is what a drone flies;
`template.kml`, from which DJI's programs make it, only gives the place of take-off.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator, Mapping
from xml.etree import ElementTree as ET

from jfto_msgs_py.mission_file import mission_items as do
from jfto_msgs_py.mission_file.document import FileItem, MissionDocument, MissionTextError
from jfto_msgs_py.mission_file.points import number
from jfto_msgs_py.mission_file.safe_xml import all_of, child, local, parse_xml, text_of

WAYLINES, TEMPLATE = "waylines.wpml", "template.kml"
_FRAMES = {
    "relativeToStartPoint": do.ABOVE_HOME,
    "WGS84": do.ABOVE_ELLIPSOID,
    "EGM96": do.ABOVE_SEA_LEVEL,
    "aboveGroundLevel": do.ABOVE_GROUND,
    "realTimeFollowSurface": do.ABOVE_GROUND,
}
_HEADINGS = ("followWayline", "manually", "fixed", "smoothTransition", "towardPOI")
_OFTEN = {"multipleDistance": do.every_metres, "multipleTiming": do.every_seconds}
_TRIGGERS = ("reachPoint", "betweenAdjacentPoints", *_OFTEN)
_SHOTS = ("takePhoto", "orientedShoot", "accurateShoot")


def read_waylines(parts: Mapping[str, bytes], source: str) -> MissionDocument:
    """All waylines of an archive's XML members by name, in order. Raises MissionTextError."""
    by_name = {name.rpartition("/")[2].lower(): data for name, data in parts.items()}
    if WAYLINES not in by_name:
        raise MissionTextError(
            f"{source}: holds a template ({TEMPLATE}) but no {WAYLINES}, which DJI's programs make "
            "of it. Export the route from DJI Pilot 2 or FlightHub 2."
        )
    root = parse_xml(by_name[WAYLINES], f"{source}, {WAYLINES}")
    roots = [root]
    if TEMPLATE in by_name:
        roots.append(parse_xml(by_name[TEMPLATE], f"{source}, {TEMPLATE}"))
    reader = _Reader(
        source, any(local(one.tag) == "action" and _is_shot(one) for one in root.iter())
    )
    folders = list(all_of(root, "Folder"))
    if not folders:
        raise MissionTextError(f"{source}: {WAYLINES} has no wayline (Folder). Export it again.")
    items = [
        item for index, folder in enumerate(folders, 1) for item in reader.wayline(folder, index)
    ]
    home = next((place for one in roots if (place := _take_off(one, source))), None)
    return MissionDocument(tuple(items), home, notes=tuple(reader.notes()), home_on_ground=True)


def _take_off(root: ET.Element, source: str) -> tuple[float, float, float] | None:
    told = next((one.text for one in all_of(root, "takeOffRefPoint") if one.text), None)
    if told is None:
        return None
    lat, lon = _two(told, "takeOffRefPoint", source)
    return lat, lon, math.nan


def _two(text: str, what: str, place: str) -> tuple[float, float]:
    parts = [part.strip() for part in text.split(",")]
    if len(parts) < 2:
        raise MissionTextError(f"{place}: {what} is {text[:40]!r}, must be two numbers or more.")
    return number(parts[0], what, place), number(parts[1], what, place)


def _index(element: ET.Element, name: str, place: str, default: int) -> int:
    told = text_of(element, name)
    return default if not told else int(number(told, name, place))


def _is_shot(action: ET.Element) -> bool:
    return text_of(action, "actionActuatorFunc") in _SHOTS


class _Reader:
    """Goes through waylines; `photos` is whether any of them takes one."""

    def __init__(self, source: str, photos: bool) -> None:
        self._source, self._photos = source, photos
        self._passed: Counter[str] = Counter()
        self._guessed = 0
        self._before: tuple[float, float] | None = None

    def notes(self) -> Iterator[str]:
        if self._passed:
            listed = ", ".join(f"{name} × {count}" for name, count in self._passed.items())
            yield f"{self._source}: not used: {listed}"
        if self._guessed:
            yield (
                f"{self._source}: {self._guessed} headings that are left to the pilot or to the "
                "drone are taken along the way"
            )

    def wayline(self, folder: ET.Element, index: int) -> Iterator[FileItem]:
        place = f"{self._source}, wayline {index}"
        mode = text_of(folder, "executeHeightMode") or ""
        if mode not in _FRAMES:
            raise MissionTextError(
                f"{place}: executeHeightMode is {mode[:40]!r}, which is not known. Use "
                f"{', '.join(_FRAMES)}."
            )
        if mode == "realTimeFollowSurface":
            self._passed["sensor's own height above ground, taken from the terrain"] += 1
        if speed := text_of(folder, "autoFlightSpeed"):
            yield do.speed(place, number(speed, "autoFlightSpeed", place))
        marks = [one for one in folder if local(one.tag) == "Placemark"]
        marks.sort(key=lambda one: _index(one, "index", place, 0))
        groups: dict[int, list[ET.Element]] = {}
        for position, mark in enumerate(marks):
            for one in (one for one in mark if local(one.tag) == "actionGroup"):
                start = _index(one, "actionGroupStartIndex", place, position)
                groups.setdefault(start, []).append(one)
        ends: set[int] = set()
        for position, mark in enumerate(marks):
            where = f"{place}, waypoint {position}"
            aims = [*self._aims(mark, marks, position, where)]
            here, ended = groups.get(position, []), position in ends
            actions = [item for one in here for item in self._group(one, position, where, ends)]
            turns = [item for item in actions if item.command in do.AIMING]
            # Without photos a waypoint is looked at from with what is set on reaching it.
            yield from aims
            yield from () if self._photos else turns
            yield self._waypoint(mark, _FRAMES[mode], where)
            if ended:
                yield do.no_more(where)
            yield from actions if self._photos else ()
        if any(end >= len(marks) for end in ends):
            yield do.no_more(place)
        self._before = None

    def _waypoint(self, mark: ET.Element, frame: int, place: str) -> FileItem:
        lat, lon = self._at(mark, place)
        height = text_of(mark, "executeHeight")
        if height is None:
            raise MissionTextError(f"{place}: has no executeHeight. Export the route again.")
        self._before = (lat, lon)
        return do.waypoint(place, frame, (lat, lon, number(height, "executeHeight", place)))

    def _at(self, mark: ET.Element, place: str) -> tuple[float, float]:
        told = text_of(mark, "Point", "coordinates")
        if not told:
            raise MissionTextError(f"{place}: has no coordinates. Export the route again.")
        lon, lat = _two(told, "coordinates", place)
        return lat, lon

    def _aims(
        self, mark: ET.Element, marks: list[ET.Element], position: int, place: str
    ) -> Iterator[FileItem]:
        """Heading and gimbal with which a waypoint is reached."""
        gimbal = text_of(mark, "waypointGimbalHeadingParam", "waypointGimbalPitchAngle")
        if gimbal:
            yield do.pitch(place, number(gimbal, "waypointGimbalPitchAngle", place))
        heading = child(mark, "waypointHeadingParam")
        mode = None if heading is None else text_of(heading, "waypointHeadingMode")
        mode = mode or "followWayline"
        if mode not in _HEADINGS:
            raise MissionTextError(
                f"{place}: waypointHeadingMode is {mode[:40]!r}, which is not known. Use "
                f"{', '.join(_HEADINGS)}."
            )
        angle = None if heading is None else text_of(heading, "waypointHeadingAngle")
        if mode == "towardPOI":
            assert heading is not None
            told = text_of(heading, "waypointPoiPoint") or ""
            lat, lon = _two(told, "waypointPoiPoint", place)
            yield do.heading(place, do.course(self._at(mark, place), (lat, lon)))
            return
        if mode == "smoothTransition" and angle:
            yield do.heading(place, number(angle, "waypointHeadingAngle", place))
            return
        self._guessed += mode in ("manually", "fixed")
        here = self._at(mark, place)
        if self._before is not None:
            yield do.heading(place, do.course(self._before, here))
        elif position + 1 < len(marks):
            yield do.heading(place, do.course(here, self._at(marks[position + 1], place)))

    def _group(
        self, group: ET.Element, position: int, place: str, ends: set[int]
    ) -> Iterator[FileItem]:
        trigger = text_of(group, "actionTrigger", "actionTriggerType") or "reachPoint"
        if trigger not in _TRIGGERS:
            raise MissionTextError(
                f"{place}: actionTriggerType is {trigger[:40]!r}, which is not known. Use "
                f"{', '.join(_TRIGGERS)}."
            )
        actions = [one for one in group if local(one.tag) == "action"]
        if trigger in _OFTEN and any(_is_shot(one) for one in actions):
            told = text_of(group, "actionTrigger", "actionTriggerParam") or ""
            every = number(told, "actionTriggerParam", place)
            if every <= 0:
                raise MissionTextError(
                    f"{place}: {trigger} every {every:g} has no end. Give actionTriggerParam."
                )
            for one in actions:
                yield from () if _is_shot(one) else self._action(one, place)
            last = _index(group, "actionGroupEndIndex", place, position)
            if last > position:
                ends.add(last)
                yield _OFTEN[trigger](place, every)
            else:
                yield do.shoot(place)
            return
        for one in actions:
            if trigger == "reachPoint":
                yield from self._action(one, place)
            else:
                self._passed[text_of(one, "actionActuatorFunc") or "an action"] += 1

    def _action(self, action: ET.Element, place: str) -> Iterator[FileItem]:
        name = text_of(action, "actionActuatorFunc") or "an action"
        given = child(action, "actionActuatorFuncParam")

        def value(key: str) -> float | None:
            told = None if given is None else text_of(given, key)
            return None if not told else number(told, key, place)

        if name == "rotateYaw":
            told = value("aircraftHeading")
            angle = value("aircraftYawRotateAngle") if told is None else told
            yield from () if angle is None else (do.heading(place, angle),)
        elif name == "gimbalRotate":
            yield from self._rotate(given, value, place)
        elif name in _SHOTS:
            if name == "orientedShoot":
                turn, tilt = value("aircraftHeading"), value("gimbalPitchRotateAngle")
                yield from () if turn is None else (do.heading(place, turn),)
                yield from () if tilt is None else (do.pitch(place, tilt),)
            yield do.shoot(place)
        else:
            self._passed[name[:40]] += 1

    def _rotate(self, given: ET.Element | None, value: do.Value, place: str) -> Iterator[FileItem]:
        mode = None if given is None else text_of(given, "gimbalRotateMode")
        if mode not in (None, "absoluteAngle"):
            raise MissionTextError(
                f"{place}: gimbalRotateMode is {mode!r}, from an angle that the file does not "
                "give. Use absoluteAngle."
            )
        tilt = value("gimbalPitchRotateAngle")
        if value("gimbalPitchRotateEnable") != 0 and tilt is not None:
            yield do.pitch(place, tilt)
        if value("gimbalYawRotateEnable") and value("gimbalYawRotateAngle"):
            self._passed["yaw of the gimbal"] += 1
