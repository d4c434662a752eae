"""QGroundControl `.plan` files: mission, fence and rally points in one JSON document.

Format: the plan file page of the QGroundControl developer guide.
"""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

from jfto_mavlink.dialect import mavlink
from jfto_mavlink.errors import MissionError, MissionFileError
from jfto_mavlink.mission.fence import (
    RALLY_COMMAND,
    Circle,
    Fence,
    Polygon,
    fence_from_items,
    fence_items,
)
from jfto_mavlink.protocol.item import (
    DEGREE_1E7,
    FRAME_ABSOLUTE,
    FRAME_HOME,
    FRAME_TERRAIN,
    Item,
    Mission,
    at,
)

ALTITUDE_MODES = {FRAME_HOME: 1, FRAME_ABSOLUTE: 2, FRAME_TERRAIN: 4}
FIRMWARE_ARDUPILOT, VEHICLE_QUADROTOR = 3, 2
# QGroundControl reads past keys that it does not know.
PARAMETERS_KEY = "jftoParameters"


def write_qgc_plan(path: Path, mission: Mission) -> None:
    """Write a mission with its fence and rally points."""
    path.write_text(json.dumps(plan_document(mission), indent=2) + "\n", encoding="utf-8")


def read_qgc_plan(path: Path) -> Mission:
    """Read a mission with its fence and rally points; raises MissionFileError."""
    try:
        document = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, ValueError) as error:
        raise MissionFileError(302, f"{path}: cannot be read: {error}.") from error
    try:
        return parse_document(document)
    except (KeyError, TypeError, ValueError, IndexError, AttributeError) as error:
        raise MissionFileError(
            302, f"{path}: is not a QGroundControl plan: {type(error).__name__} {error}."
        ) from error
    except MissionError as error:
        raise MissionFileError(302, f"{path}: {error}") from error


def plan_document(mission: Mission) -> dict[str, Any]:
    """The JSON document of a mission."""
    home = mission.items[0] if mission.items else Item(mavlink.MAV_CMD_NAV_WAYPOINT)
    fence = fence_from_items(mission.fence)
    geo_fence: dict[str, Any] = {
        "version": 2,
        "polygons": [
            {"version": 1, "inclusion": p.inclusion, "polygon": [list(v) for v in p.vertices]}
            for p in fence.polygons
        ],
        "circles": [
            {
                "version": 1,
                "inclusion": c.inclusion,
                "circle": {"center": list(c.center), "radius": c.radius_m},
            }
            for c in fence.circles
        ],
    }
    if fence.return_point is not None:
        geo_fence["breachReturn"] = [*fence.return_point, 0.0]
    return {
        "fileType": "Plan",
        "version": 1,
        "groundStation": "QGroundControl",
        "mission": {
            "version": 2,
            "firmwareType": FIRMWARE_ARDUPILOT,
            "vehicleType": VEHICLE_QUADROTOR,
            "globalPlanAltitudeMode": ALTITUDE_MODES[FRAME_HOME],
            "cruiseSpeed": 15,
            "hoverSpeed": 5,
            "plannedHomePosition": [home.lat_deg, home.lon_deg, home.z],
            "items": [_simple_item(item, n) for n, item in enumerate(mission.items[1:], start=1)],
        },
        "geoFence": geo_fence,
        "rallyPoints": {
            "version": 2,
            "points": [[item.lat_deg, item.lon_deg, item.z] for item in mission.rally],
        },
        **({PARAMETERS_KEY: dict(mission.parameters)} if mission.parameters else {}),
    }


def parse_document(document: dict[str, Any]) -> Mission:
    """The mission in a JSON document; KeyError, TypeError or ValueError if it is not one."""
    if document["fileType"] != "Plan":
        raise ValueError(f'fileType is "{document["fileType"]}", must be "Plan"')
    section = document["mission"]
    items = [_read_item(entry) for entry in _flatten(section["items"])]
    if items:
        lat, lon, height = section["plannedHomePosition"]
        items.insert(0, at(mavlink.MAV_CMD_NAV_WAYPOINT, FRAME_ABSOLUTE, lat, lon, height))
    geo_fence = document.get("geoFence", {})
    fence = Fence(
        tuple(
            Polygon(tuple((v[0], v[1]) for v in p["polygon"]), p["inclusion"])
            for p in geo_fence.get("polygons", ())
        ),
        tuple(
            Circle(tuple(c["circle"]["center"]), c["circle"]["radius"], c["inclusion"])
            for c in geo_fence.get("circles", ())
        ),
        tuple(geo_fence["breachReturn"][:2]) if geo_fence.get("breachReturn") else None,
    )
    rally = tuple(
        at(RALLY_COMMAND, FRAME_HOME, *point)
        for point in document.get("rallyPoints", {}).get("points", ())
    )
    parameters = tuple(
        (str(name), float(value)) for name, value in document.get(PARAMETERS_KEY, {}).items()
    )
    return Mission(tuple(items), fence_items(fence), rally, parameters)


def _simple_item(item: Item, number: int) -> dict[str, Any]:
    x, y = (item.lat_deg, item.lon_deg) if item.has_position else (item.x, item.y)
    params = [None if math.isnan(p) else p for p in (*item.params, x, y, item.z)]
    entry: dict[str, Any] = {
        "type": "SimpleItem",
        "command": item.command,
        "doJumpId": number,
        "frame": item.frame,
        "params": params,
        "autoContinue": bool(item.autocontinue),
    }
    if item.is_nav and item.has_position:
        entry["Altitude"] = item.z
        entry["AltitudeMode"] = ALTITUDE_MODES.get(item.frame, 1)
        entry["AMSLAltAboveTerrain"] = None
    return entry


def _read_item(entry: dict[str, Any]) -> Item:
    command, frame = int(entry["command"]), int(entry["frame"])
    values = [math.nan if p is None else float(p) for p in entry["params"]]
    p1, p2, p3, p4, x, y, z = values
    plain = Item(command, frame)
    scale = DEGREE_1E7 if plain.has_position else 1
    # QGroundControl writes null for a place that is not given.
    x, y, z = (0.0 if math.isnan(value) else value for value in (x, y, z))
    return Item(
        command,
        frame,
        (p1, p2, p3, p4),
        round(x * scale),
        round(y * scale),
        z,
        0,
        int(entry.get("autoContinue", True)),
    )


def _flatten(entries: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Simple items, also those that surveys carry along."""
    simple = []
    for entry in entries:
        if entry["type"] == "SimpleItem":
            simple.append(entry)
        elif "TransectStyleComplexItem" in entry:
            simple += _flatten(entry["TransectStyleComplexItem"]["Items"])
        else:
            raise ValueError(
                f"holds a {entry.get('complexItemType', entry['type'])} item, which only "
                "QGroundControl can expand"
            )
    return simple
