"""Writes QGroundControl `.plan` files: mission, fence and rally points in one JSON document."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

from jfto_mavlink.dialect import mavlink
from jfto_mavlink.errors import MissionFileError
from jfto_mavlink.mission.fence import fence_from_items
from jfto_mavlink.protocol.item import FRAME_ABSOLUTE, FRAME_HOME, FRAME_TERRAIN, Item, Mission
from jfto_msgs_py.mission_file.document import FENCE_RETURN
from jfto_msgs_py.mission_file.plan_json import PARAMETERS_KEY

FRAME_HOME_INT = mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT_INT
ALTITUDE_MODES = {FRAME_HOME: 1, FRAME_ABSOLUTE: 2, FRAME_TERRAIN: 4}
FIRMWARE_ARDUPILOT, VEHICLE_QUADROTOR = 3, 2


def write_qgc_plan(path: Path, mission: Mission) -> None:
    """Write a mission with its fence and rally points."""
    path.write_text(json.dumps(plan_document(mission), indent=2) + "\n", encoding="utf-8")


def plan_document(mission: Mission) -> dict[str, Any]:
    """The JSON document of a mission; raises MissionFileError for what it has no place for."""
    for number, item in enumerate(mission.rally):
        if item.frame not in (FRAME_HOME, FRAME_HOME_INT):
            raise MissionFileError(
                302,
                f"rally point {number}: its height is in frame {item.frame}, a .plan has only "
                "heights above home. Write a .waypoints file instead.",
            )
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
        back = next(item for item in mission.fence if item.command == FENCE_RETURN)
        geo_fence["breachReturn"] = [*fence.return_point, back.z]
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
