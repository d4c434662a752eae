"""Waypoints that a user brings: CSV, GeoJSON, a QGroundControl plan or a `.waypoints` file."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from jfto_msgs_py.errors import InputError, WaypointError
from jfto_msgs_py.mission_file import PLAN_SUFFIX, WPL_SUFFIXES
from jfto_msgs_py.records.plan import Waypoint
from jfto_msgs_py.text_encoding import read_foreign_text
from jfto_planner.coverage.check_waypoints import check_waypoints
from jfto_planner.coverage.file_csv import read_csv
from jfto_planner.coverage.file_geojson import read_geojson
from jfto_planner.coverage.file_mission import read_mission_photos
from jfto_planner.coverage.raw_waypoint import RawWaypoint
from jfto_world.terrain import Dem

_LARGEST_BYTES = 64 * 2**20
_TEXTS = {".csv": ("CSV", read_csv), ".geojson": ("GeoJSON", read_geojson)}
_TEXTS[".json"] = _TEXTS[".geojson"]


@dataclass(frozen=True)
class WaypointSet:
    """Waypoints of a file, and `notes` on what it holds that is not used, a line each."""

    waypoints: tuple[Waypoint, ...]
    notes: tuple[str, ...]


def read_waypoints(path: str | Path, dem: Dem) -> tuple[Waypoint, ...]:
    """Waypoints of a file, in ENU metres about the DEM's origin.

    Heights are altitudes in the DEM's own datum or above the ground below
    (docs/explanation/coverage.md).

    Parameters
    ----------
    path
        CSV, GeoJSON, KML or a mission file.
    dem
        Its origin and heights are what the waypoints are given in.

    Returns
    -------
    tuple of Waypoint
        Numbered from 0 in the order of the file.

    Raises
    ------
    WaypointError
        Names file, line or item, reason and cure.
    """
    return read_waypoint_set(path, dem).waypoints


def read_waypoint_set(path: str | Path, dem: Dem) -> WaypointSet:
    """Waypoints of a file with notes on what it holds besides.

    Parameters
    ----------
    path
        As for `read_waypoints`.
    dem
        Its origin and heights are what the waypoints are given in.

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
    suffix = path.suffix.lower()
    notes: list[str] = []
    if suffix in _TEXTS:
        raw = _of_text(path, dem, notes)
    elif suffix in (PLAN_SUFFIX, *WPL_SUFFIXES):
        raw = read_mission_photos(path, dem, notes)
    else:
        raise WaypointError(
            f"{path} is of no known waypoint format. Use .csv, .geojson, QGroundControl's .plan "
            "or Mission Planner's .waypoints."
        )
    if not raw:
        raise WaypointError(f"{path} holds no waypoint. Write one or more into it.")
    check_waypoints(raw, dem, str(path))
    waypoints = tuple(
        Waypoint(number, item.position_m, item.yaw_deg, item.pitch_deg)
        for number, item in enumerate(raw)
    )
    return WaypointSet(waypoints, tuple(notes))


def _of_text(path: Path, dem: Dem, notes: list[str]) -> list[RawWaypoint]:
    name, read = _TEXTS[path.suffix.lower()]
    try:
        text, encoding = read_foreign_text(path, name, _LARGEST_BYTES)
    except InputError as error:
        raise WaypointError(str(error)) from None
    if not text.strip():
        raise WaypointError(f"{path} is empty. Write one waypoint or more into it.")
    if dem.above_ellipsoid:
        notes.append(
            f"{path}: altitudes are taken above the {dem.height_datum}, as the terrain's; where "
            "they are above sea level, give heights above ground (agl_m)"
        )
    if not encoding:
        return read(text, str(path), dem, notes)
    try:
        found = read(text, str(path), dem, notes)
    except WaypointError as error:
        raise WaypointError(
            f"{error} It is not in UTF-8 and was read as {encoding.upper()}; if that is wrong, "
            "save it in UTF-8."
        ) from None
    notes.append(f"{path}: is not in UTF-8, read as {encoding.upper()}")
    return found
