"""Waypoints that a user brings: CSV, GeoJSON or a QGroundControl plan."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from jfto_msgs_py.errors import WaypointError
from jfto_msgs_py.records.plan import Waypoint
from jfto_planner.coverage.check_waypoints import check_waypoints
from jfto_planner.coverage.file_csv import read_csv
from jfto_planner.coverage.file_geojson import read_geojson
from jfto_planner.coverage.file_qgc import read_qgc_plan
from jfto_planner.coverage.raw_waypoint import RawWaypoint
from jfto_world.terrain import Dem

_LARGEST_BYTES = 64 * 1024 * 1024


@dataclass(frozen=True)
class _Format:
    name: str
    read: Callable[[str, str, Dem], list[RawWaypoint]]


_FORMATS = {
    ".csv": _Format("CSV", read_csv),
    ".geojson": _Format("GeoJSON", read_geojson),
    ".json": _Format("GeoJSON", read_geojson),
    ".plan": _Format("QGroundControl plan", read_qgc_plan),
}


def read_waypoints(path: str | Path, dem: Dem) -> tuple[Waypoint, ...]:
    """Waypoints of a file, numbered from 0 in its order, in ENU metres about the DEM's origin.

    Heights are altitudes in the DEM's own datum or above the ground below
    (docs/explanation/coverage.md).
    Raises WaypointError, naming file, line or item, reason and cure.
    """
    path = Path(path)
    format_ = _FORMATS.get(path.suffix.lower())
    if format_ is None:
        raise WaypointError(
            f"{path} is of no known waypoint format. Use .csv, .geojson or QGroundControl's .plan."
        )
    try:
        if path.stat().st_size > _LARGEST_BYTES:
            raise WaypointError(f"{path} is larger than 64 MiB. Split it into several missions.")
        text = path.read_text(encoding="utf-8-sig")
    except UnicodeDecodeError as error:
        raise WaypointError(
            f"{path} is not UTF-8 text ({error.reason} at byte {error.start}). "
            f"Save it as {format_.name} in UTF-8."
        ) from error
    except OSError as error:
        raise WaypointError(
            f"{path} cannot be read ({error.strerror}). Check its name and permissions."
        ) from error
    if not text.strip():
        raise WaypointError(f"{path} is empty. Write one waypoint or more into it.")
    raw = format_.read(text, str(path), dem)
    if not raw:
        raise WaypointError(f"{path} holds no waypoint. Write one or more into it.")
    check_waypoints(raw, dem, str(path))
    return tuple(
        Waypoint(number, item.position_m, item.yaw_deg, item.pitch_deg)
        for number, item in enumerate(raw)
    )
