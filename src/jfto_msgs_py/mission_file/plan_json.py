"""QGroundControl `.plan` files: mission, fence and rally points in one JSON document.

Format: the plan file page of the QGroundControl developer guide.
"""

from __future__ import annotations

import json
import math
from collections import Counter
from typing import Any

from jfto_msgs_py.mission_file.document import (
    CIRCLE_IN,
    CIRCLE_OUT,
    FENCE_COMMANDS,
    FENCE_RETURN,
    POLYGON_IN,
    POLYGON_OUT,
    RALLY,
    FileItem,
    MissionDocument,
    MissionTextError,
    finite,
    whole,
)
from jfto_msgs_py.mission_file.jumps import with_jumps

# QGroundControl reads past keys that it does not know.
PARAMETERS_KEY = "jftoParameters"
_ABSOLUTE, _ABOVE_HOME = 0, 3
_ARDUPILOT = 3
# MAV_TYPE of what flies as a copter does, and in words those that a station also plans for.
_COPTERS = (0, 2, 3, 4, 13, 14, 15, 29, 35)
_VEHICLES = {1: "a plane", 10: "a rover", 11: "a boat", 12: "a submarine"} | dict.fromkeys(
    range(19, 26), "a VTOL plane"
)
_AGAIN = "Save it again in QGroundControl."
# Keys whose values are used, or say nothing that would change a flight.
_KNOWN = {
    "the plan": {"fileType", "version", "groundStation", "mission", "geoFence", "rallyPoints",
                 PARAMETERS_KEY},
    "mission": {"version", "items", "plannedHomePosition", "firmwareType", "vehicleType",
                "globalPlanAltitudeMode", "cruiseSpeed", "hoverSpeed"},
    "geoFence": {"version", "polygons", "circles", "breachReturn"},
    "rallyPoints": {"version", "points"},
    "polygon": {"version", "inclusion", "polygon"},
    "circle": {"version", "inclusion", "circle"},
    "item": {"type", "command", "frame", "params", "autoContinue", "doJumpId", "Altitude",
             "AltitudeMode", "AMSLAltAboveTerrain", "AMSLAltTerrain", "MISSION_ITEM_ID",
             "coordinate"},
}  # fmt: skip
_SECTIONS = {"mission": 2, "geoFence": 2, "rallyPoints": 2, "polygon": 1, "circle": 1}


def parse_plan(text: str, name: str) -> MissionDocument:
    """What the text of a `.plan` holds. Raises MissionTextError, naming file and item."""
    return plan_of_document(json_of_plan(text, name), name)


def plan_of_document(document: Any, name: str) -> MissionDocument:
    """The same of parsed JSON."""
    return _PlanReader(name).read(document)


def json_of_plan(text: str, name: str) -> Any:
    """Parsed JSON of a `.plan`, nothing of it checked. Raises MissionTextError."""

    def unique(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
        found = dict(pairs)
        if len(found) != len(pairs):
            doubled = Counter(key for key, _ in pairs).most_common(1)[0][0]
            raise MissionTextError(
                f"{name}: {doubled[:40]!r} is given twice in one object. {_AGAIN}"
            )
        return found

    try:
        return json.loads(text, object_pairs_hook=unique)
    except json.JSONDecodeError as error:
        raise MissionTextError(
            f"{name}, line {error.lineno}, column {error.colno}: cannot be read: is not JSON "
            f"({error.msg}). The file is damaged or cut short; save it again."
        ) from None
    except RecursionError:
        raise MissionTextError(f"{name}: is nested too deeply. {_AGAIN}") from None
    except ValueError as error:
        # A whole number of thousands of digits.
        raise MissionTextError(f"{name}: cannot be read: {str(error)[:80]}. {_AGAIN}") from None


class _PlanReader:
    """Goes through one document and collects what is not taken over."""

    def __init__(self, name: str) -> None:
        self._name = name
        self._unused: Counter[str] = Counter()
        self._notes: list[str] = []
        # QGroundControl's numbers of the items, which its jumps go by, in their order.
        self._numbers: list[int | None] = []

    def read(self, document: Any) -> MissionDocument:
        if not isinstance(document, dict) or document.get("fileType") != "Plan":
            kind = document.get("fileType") if isinstance(document, dict) else None
            raise MissionTextError(
                f"{self._name}: is not a QGroundControl plan: fileType is {_short(kind)}, must be "
                '"Plan". Save it with Plan › Save.'
            )
        self._check_version(document, 1, self._name)
        self._keep_unknown(document, "the plan")
        if not isinstance(document.get("mission"), dict):
            raise MissionTextError(
                f"{self._name}: is not a QGroundControl plan with a mission. {_AGAIN}"
            )
        mission = self._section(document, "mission")
        if mission.get("firmwareType", _ARDUPILOT) != _ARDUPILOT:
            self._notes.append(
                f"{self._name}: was made for firmware {_short(mission['firmwareType'])}; its items "
                f"are taken as ArduPilot's ({_ARDUPILOT})"
            )
        self._note_vehicle(mission.get("vehicleType", 2))
        entries = mission.get("items")
        if not isinstance(entries, list):
            raise MissionTextError(f"{self._name}: mission.items is missing. {_AGAIN}")
        items = self._items(entries, f"{self._name}, item ", 0)
        home = self._home(mission.get("plannedHomePosition"))
        speed = mission.get("hoverSpeed")
        fence = self._fence(self._section(document, "geoFence"))
        rally = self._rally(self._section(document, "rallyPoints"))
        parameters = self._parameters(document.get(PARAMETERS_KEY, {}))
        if self._unused:
            self._notes.append(f"{self._name}: not used: {', '.join(sorted(self._unused))}")
        pairs = zip(items, self._numbers, strict=True)
        kept = [pair for pair in pairs if pair[0].command not in FENCE_COMMANDS | {RALLY}]
        return MissionDocument(
            with_jumps([item for item, _ in kept], [number for _, number in kept]),
            home,
            # Also those that stand among the items of the mission.
            fence + tuple(item for item in items if item.command in FENCE_COMMANDS),
            rally + tuple(item for item in items if item.command == RALLY),
            parameters,
            tuple(self._notes),
            finite(speed, "hoverSpeed", self._name) if speed is not None else None,
        )

    def _note_vehicle(self, kind: Any) -> None:
        if isinstance(kind, bool) or kind not in _COPTERS:
            what = _VEHICLES.get(kind, "no copter") if isinstance(kind, int) else "no copter"
            self._notes.append(
                f"{self._name}: was made for {what} (vehicleType {_short(kind)}); its items are "
                "taken as a copter's"
            )

    def _section(self, document: dict[str, Any], key: str) -> dict[str, Any]:
        section = document.get(key)
        if section is None:
            return {}
        if not isinstance(section, dict):
            raise MissionTextError(
                f"{self._name}: {key} is {_short(section)}, must be an object. {_AGAIN}"
            )
        self._check_version(section, _SECTIONS[key], f"{self._name}: {key}")
        self._keep_unknown(section, key)
        return section

    def _check_version(self, part: dict[str, Any], known: int, place: str) -> None:
        version = part.get("version", known)
        if version != known or isinstance(version, bool):
            raise MissionTextError(
                f"{place}: is of version {_short(version)}, version {known} can be read. Save it "
                "again with a current QGroundControl."
            )

    def _keep_unknown(self, part: dict[str, Any], kind: str) -> None:
        self._unused.update(
            f"{'' if kind == 'the plan' else kind + '.'}{str(key)[:40]}"
            for key in part
            if key not in _KNOWN[kind]
        )

    def _home(self, place: Any) -> Any:
        if place is None or place == []:
            return None
        where = f"{self._name}: plannedHomePosition"
        if isinstance(place, list) and len(place) == 3 and _is_open(place[2]):
            return (*self._place(place[:2], 2, where), math.nan)
        return self._place(place, 3, where)

    def _place(self, value: Any, count: int, place: str) -> Any:
        if not isinstance(value, list) or len(value) != count:
            raise MissionTextError(
                f"{place}: is {_short(value)}, must be a list of {count} numbers. {_AGAIN}"
            )
        names = ("latitude", "longitude", "altitude")[:count]
        numbers = tuple(finite(v, n, place) for v, n in zip(value, names, strict=True))
        if abs(numbers[0]) > 90 or abs(numbers[1]) > 180:
            raise MissionTextError(
                f"{place}: {numbers[0]}, {numbers[1]} is not on Earth. Latitude comes first, in "
                "degrees."
            )
        return numbers

    def _items(self, entries: list[Any], prefix: str, depth: int) -> list[FileItem]:
        """Simple items, also those that surveys and corridor scans carry along."""
        found: list[FileItem] = []
        for index, entry in enumerate(entries, start=1):
            place = f"{prefix}{index}"
            if not isinstance(entry, dict):
                raise MissionTextError(f"{place}: is not a mission item. {_AGAIN}")
            inner = entry.get("TransectStyleComplexItem")
            if entry.get("type") == "SimpleItem":
                found.append(self._simple(entry, place))
            elif isinstance(inner, dict) and isinstance(inner.get("Items"), list) and depth < 3:
                self._note_survey(entry, inner, place)
                found += self._items(inner["Items"], f"{place}.", depth + 1)
            else:
                kind = entry.get("complexItemType") or entry.get("type")
                raise MissionTextError(
                    f"{place}: is a {_short(kind)} item, which has no waypoints of its own: only "
                    "QGroundControl can expand it. Upload it to a vehicle (a simulated one will "
                    "do), download it again, and save that."
                )
        return found

    def _note_survey(self, entry: dict[str, Any], inner: dict[str, Any], place: str) -> None:
        camera = inner.get("CameraCalc")
        name = camera.get("CameraName") if isinstance(camera, dict) else None
        kind, count = _short(entry.get("complexItemType")), len(inner["Items"])
        text = f"{place}: a {kind} whose own {count} items are taken"
        if name:
            text += f"; that it was laid out for camera {_short(name)} is not used"
        self._notes.append(text)

    def _simple(self, entry: dict[str, Any], place: str) -> FileItem:
        self._keep_unknown(entry, "item")
        params = entry.get("params")
        if not isinstance(params, list) or len(params) != 7:
            raise MissionTextError(f"{place}: params must be a list of 7 numbers. {_AGAIN}")
        values = tuple(
            math.nan if _is_open(value) else finite(value, f"params[{index}]", place)
            for index, value in enumerate(params)
        )
        again, number = entry.get("autoContinue", True), entry.get("doJumpId")
        self._numbers.append(None if number is None else whole(number, "doJumpId", place))
        return FileItem(
            place,
            whole(entry.get("command"), "command", place),
            whole(entry.get("frame"), "frame", place, 0, 255),
            values,
            0,
            int(again) if isinstance(again, bool) else whole(again, "autoContinue", place, 0, 255),
        )

    def _fence(self, section: dict[str, Any]) -> tuple[FileItem, ...]:
        items: list[FileItem] = []
        for index, polygon in enumerate(self._list(section, "polygons")):
            place = f"{self._name}: geoFence polygon {index}"
            self._shape(polygon, "polygon", place)
            vertices = polygon["polygon"]
            if not isinstance(vertices, list) or len(vertices) < 3:
                raise MissionTextError(f"{place}: has no 3 vertices. Draw it again.")
            command = POLYGON_IN if polygon["inclusion"] else POLYGON_OUT
            for vertex in vertices:
                lat, lon = self._place(vertex, 2, place)
                items.append(_at(place, command, _ABSOLUTE, (lat, lon, 0.0), len(vertices)))
        for index, circle in enumerate(self._list(section, "circles")):
            place = f"{self._name}: geoFence circle {index}"
            self._shape(circle, "circle", place)
            shape = circle["circle"]
            if not isinstance(shape, dict) or set(shape) - {"center", "radius"}:
                raise MissionTextError(f"{place}: must have center and radius only. {_AGAIN}")
            radius = finite(shape.get("radius"), "radius", place)
            command = CIRCLE_IN if circle["inclusion"] else CIRCLE_OUT
            lat, lon = self._place(shape.get("center"), 2, place)
            items.append(_at(place, command, _ABSOLUTE, (lat, lon, 0.0), radius))
        back = section.get("breachReturn")
        if back:
            place = f"{self._name}: geoFence.breachReturn"
            items.append(_at(place, FENCE_RETURN, _ABSOLUTE, self._place(back, 3, place)))
        return tuple(items)

    def _shape(self, shape: Any, kind: str, place: str) -> None:
        if not isinstance(shape, dict) or kind not in shape:
            raise MissionTextError(f"{place}: has no {kind}. {_AGAIN}")
        self._check_version(shape, _SECTIONS[kind], place)
        self._keep_unknown(shape, kind)
        if not isinstance(shape.get("inclusion"), bool):
            raise MissionTextError(
                f"{place}: inclusion is {_short(shape.get('inclusion'))}, must be true or false: "
                f"to stay inside or outside. {_AGAIN}"
            )

    def _rally(self, section: dict[str, Any]) -> tuple[FileItem, ...]:
        found = []
        for index, point in enumerate(self._list(section, "points")):
            place = f"{self._name}: rally point {index}"
            found.append(_at(place, RALLY, _ABOVE_HOME, self._place(point, 3, place)))
        return tuple(found)

    def _list(self, section: dict[str, Any], key: str) -> list[Any]:
        value = section.get(key, [])
        if not isinstance(value, list):
            raise MissionTextError(
                f"{self._name}: {key} is {_short(value)}, must be a list. {_AGAIN}"
            )
        return value

    def _parameters(self, section: Any) -> tuple[tuple[str, float], ...]:
        place = f"{self._name}: {PARAMETERS_KEY}"
        if not isinstance(section, dict):
            raise MissionTextError(f"{place}: is {_short(section)}, must be an object. {_AGAIN}")
        return tuple((name, finite(value, name, place)) for name, value in section.items())


def _is_open(value: Any) -> bool:
    return value is None or (isinstance(value, float) and math.isnan(value))


def _at(
    place: str, command: int, frame: int, where: tuple[float, float, float], first: float = 0.0
) -> FileItem:
    return FileItem(place, command, frame, (first, 0.0, 0.0, 0.0, *where))


def _short(value: Any) -> str:
    text = repr(value)
    return text if len(text) <= 40 else f"{text[:37]}..."
