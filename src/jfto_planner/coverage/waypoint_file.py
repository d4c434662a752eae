"""Waypoints that a user brings, in any format that `jfto_msgs_py.mission_file` reads."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from jfto_msgs_py.errors import WaypointError
from jfto_msgs_py.mission_file import MissionTextError, PointDocument, read_any
from jfto_msgs_py.records.plan import Waypoint
from jfto_planner.coverage.check_waypoints import check_waypoints
from jfto_planner.coverage.file_mission import photos_of_mission
from jfto_planner.coverage.places import Assumed, Places
from jfto_planner.coverage.raw_waypoint import RawWaypoint
from jfto_world.terrain import Dem


@dataclass(frozen=True)
class WaypointSet:
    """Waypoints of a file, and `notes` on what it holds that is not used, a line each."""

    waypoints: tuple[Waypoint, ...]
    notes: tuple[str, ...]


def read_waypoints(
    path: str | Path, dem: Dem, assumed: Assumed | None = None
) -> tuple[Waypoint, ...]:
    """Waypoints of a file, in ENU metres about the DEM's origin.

    Heights are above whatever the file says (docs/how-to/files.md).

    Parameters
    ----------
    path
        CSV, GeoJSON, KML, KMZ, DJI's waylines, Litchi's table or a mission file.
    dem
        Its origin is what the waypoints are given about.
    assumed
        Home and heights where the file is silent.

    Returns
    -------
    tuple of Waypoint
        Numbered from 0 in the order of the file.

    Raises
    ------
    WaypointError
        Names file, line or item, reason and cure.
    """
    return read_waypoint_set(path, dem, assumed).waypoints


def read_waypoint_set(path: str | Path, dem: Dem, assumed: Assumed | None = None) -> WaypointSet:
    """Waypoints of a file with notes on what it holds besides.

    Parameters
    ----------
    path
        As for `read_waypoints`.
    dem
        As for `read_waypoints`.
    assumed
        As for `read_waypoints`.

    Returns
    -------
    WaypointSet
        Waypoints and notes.

    Raises
    ------
    WaypointError
        Names file, line or item, reason and cure.
    """
    path = Path(path)
    notes: list[str] = []
    try:
        document = read_any(path)
    except MissionTextError as error:
        raise WaypointError(str(error)) from None
    if isinstance(document, PointDocument):
        raw = _of_points(document, Places(str(path), dem, notes, assumed), notes)
    else:
        places = Places(str(path), dem, notes, assumed, document)
        raw = photos_of_mission(document, str(path), places, notes)
    if not raw:
        raise WaypointError(f"{path} holds no waypoint. Write one or more into it.")
    check_waypoints(raw, dem, str(path))
    waypoints = tuple(
        Waypoint(number, item.position_m, item.yaw_deg, item.pitch_deg)
        for number, item in enumerate(raw)
    )
    return WaypointSet(waypoints, tuple(notes))


def _of_points(document: PointDocument, places: Places, notes: list[str]) -> list[RawWaypoint]:
    found = [
        RawWaypoint(point.place, places.point(point), point.yaw_deg, point.pitch_deg)
        for point in document.points
    ]
    places.finish()
    notes.extend(document.notes)
    return found
