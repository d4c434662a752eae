"""Waypoints of a QGroundControl plan (its file format, mission version 2)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from jfto_msgs_py.errors import WaypointError
from jfto_planner.coverage.file_geojson import load_json
from jfto_planner.coverage.raw_waypoint import RawWaypoint, from_geodetic, number
from jfto_world.terrain import Dem

# MAV_CMD numbers, and MAV_FRAME numbers with and without _INT (mavlink.io, common.xml).
_WAYPOINT, _SPLINE_WAYPOINT = 16, 82
_NOT_PHOTOS = {20: "return", 21: "landing", 22: "take-off"}
_LAST_NAVIGATION = 95
_MOUNT_CONTROL, _GIMBAL_PITCH_YAW = 205, 1000
_SEA_LEVEL, _ABOVE_HOME, _ABOVE_GROUND = (0, 5), (3, 6), (10, 11)


def read_qgc_plan(text: str, source: str, dem: Dem) -> list[RawWaypoint]:
    """Waypoints of the mission, surveys included; take-off, landing and return are passed over.

    A gimbal command sets the pitch of what follows it, a waypoint's fourth parameter its yaw.
    Raises WaypointError, also where the DEM's heights are above the ellipsoid: a plan's are above
    sea level.
    """
    document = load_json(text, source)
    mission = document.get("mission") if isinstance(document, dict) else None
    if not isinstance(mission, dict) or document.get("fileType") != "Plan":
        raise WaypointError(
            f"{source}: is not a QGroundControl plan with a mission. Save it with Plan › Save."
        )
    items = mission.get("items")
    if not isinstance(items, list):
        raise WaypointError(f"{source}: mission.items is missing. Save the plan again.")
    reader = _Reader(source, dem, mission.get("plannedHomePosition"))
    reader.read(items, f"{source}, item ")
    return reader.found


@dataclass
class _Reader:
    source: str
    dem: Dem
    home: Any

    def __post_init__(self) -> None:
        self.found: list[RawWaypoint] = []
        self.pitch_deg = -90.0

    def read(self, items: list[Any], prefix: str) -> None:
        for index, item in enumerate(items, start=1):
            place = f"{prefix}{index}"
            if not isinstance(item, dict):
                raise WaypointError(f"{place}: is not a mission item. Save the plan again.")
            inner = item.get("TransectStyleComplexItem")
            if item.get("type") == "SimpleItem":
                self._simple(item, place)
            elif isinstance(inner, dict) and isinstance(inner.get("Items"), list):
                self.read(inner["Items"], f"{place}.")
            else:
                raise WaypointError(
                    f"{place}: is a {item.get('complexItemType') or item.get('type')!r}, which "
                    "has no waypoints of its own. Replace it by waypoints."
                )

    def _simple(self, item: dict[str, Any], place: str) -> None:
        command = int(number(item.get("command"), "command", place))
        params = item.get("params")
        if not isinstance(params, list) or len(params) != 7:
            raise WaypointError(f"{place}: params must be a list of 7. Save the plan again.")
        if command in (_MOUNT_CONTROL, _GIMBAL_PITCH_YAW):
            self.pitch_deg = number(params[0], "gimbal pitch", place)
        elif command in (_WAYPOINT, _SPLINE_WAYPOINT):
            self._waypoint(item, params, place)
        elif command <= _LAST_NAVIGATION and command not in _NOT_PHOTOS:
            raise WaypointError(
                f"{place}: command {command} is neither a waypoint nor a take-off, return or "
                "landing. Replace it by a waypoint (16)."
            )

    def _waypoint(self, item: dict[str, Any], params: list[Any], place: str) -> None:
        lat_deg = number(params[4], "latitude", place)
        lon_deg = number(params[5], "longitude", place)
        height_m = number(params[6], "altitude", place)
        yaw_deg = 0.0 if params[3] is None else number(params[3], "yaw", place)
        frame = int(number(item.get("frame"), "frame", place))
        if frame in _ABOVE_HOME:
            height_m += self._home_altitude(place)
        elif frame not in _SEA_LEVEL + _ABOVE_GROUND:
            raise WaypointError(
                f"{place}: altitude frame {frame} is unknown. Use AMSL (0), relative to home (3) "
                "or above terrain (10)."
            )
        if frame not in _ABOVE_GROUND and self.dem.above_ellipsoid:
            raise WaypointError(
                f"{place}: its altitude is above sea level, but the terrain's heights are above "
                f"the {self.dem.height_datum}; these differ by up to 100 m. Give altitudes above "
                "terrain, or a terrain with heights above sea level."
            )
        position = from_geodetic(
            self.dem, lat_deg, lon_deg, height_m, frame in _ABOVE_GROUND, place
        )
        self.found.append(RawWaypoint(place, position, yaw_deg % 360.0, self.pitch_deg))

    def _home_altitude(self, place: str) -> float:
        if not isinstance(self.home, list) or len(self.home) != 3:
            raise WaypointError(
                f"{place}: its altitude is relative to home, but plannedHomePosition is missing. "
                "Set the planned home and save the plan again."
            )
        return number(self.home[2], "altitude of plannedHomePosition", self.source)
