"""Waypoints as a table of comma-separated values."""

from __future__ import annotations

import csv
import io

from jfto_msgs_py.errors import WaypointError
from jfto_planner.coverage.other_names import ANGLES, angles, not_used
from jfto_planner.coverage.raw_waypoint import RawWaypoint, from_geodetic, ground_height, number
from jfto_world.terrain import Dem

_PLACES = (("x_m", "y_m"), ("lat", "lon"))
_HEIGHT = {"x_m": "z_m", "lat": "alt"}
_ABOVE_GROUND = "agl_m"
_KNOWN = ("x_m", "y_m", "z_m", "lat", "lon", "alt", "agl_m", *ANGLES)
_EXAMPLE = "x_m,y_m,z_m or lat,lon,alt, with agl_m in place of the height if it is above ground"


def read_csv(text: str, source: str, dem: Dem, notes: list[str]) -> list[RawWaypoint]:
    """Waypoints of a CSV with a header; `notes` gets a line on further columns.

    Raises WaypointError.
    """
    reader = csv.reader(io.StringIO(text), strict=True)
    try:
        rows = [(reader.line_num, row) for row in reader if any(cell.strip() for cell in row)]
    except csv.Error as error:
        raise WaypointError(
            f"{source}, line {reader.line_num}: is not CSV ({error}). Check its quotes."
        ) from error
    header = [cell.strip().lower() for cell in rows[0][1]]
    place_columns, height_column = _columns(header, source)
    result = []
    for line, row in rows[1:]:
        place = f"{source}, line {line}"
        if len(row) != len(header):
            raise WaypointError(
                f"{place}: has {len(row)} values, the header names {len(header)}. "
                "Separate values with commas, write decimals with a point."
            )
        cells = {name: cell.strip() for name, cell in zip(header, row, strict=True)}
        first, second = (number(cells[name], name, place) for name in place_columns)
        height = number(cells[height_column], height_column, place)
        above_ground = height_column == _ABOVE_GROUND
        if place_columns == ("lat", "lon"):
            position = from_geodetic(dem, first, second, height, above_ground, place)
        elif above_ground:
            position = (first, second, ground_height(dem, first, second, place) + height)
        else:
            position = (first, second, height)
        result.append(RawWaypoint(place, position, *angles(cells, place)))
    notes.extend(not_used(source, header, (*place_columns, height_column, *ANGLES)))
    return result


def _columns(header: list[str], source: str) -> tuple[tuple[str, str], str]:
    """Names of the two columns of place and of the one of height."""
    place = f"{source}, line 1"
    doubled = sorted({name for name in header if name in _KNOWN and header.count(name) > 1})
    if doubled:
        raise WaypointError(f"{place}: column {doubled[0]} appears twice. Take one out.")
    found = [pair for pair in _PLACES if set(pair) <= set(header)]
    if len(found) != 1:
        hint = " Separate columns with commas." if len(header) == 1 and ";" in header[0] else ""
        raise WaypointError(
            f"{place}: the header is {','.join(header)!r}, needs the columns {_EXAMPLE}.{hint}"
        )
    heights = [name for name in (_HEIGHT[found[0][0]], _ABOVE_GROUND) if name in header]
    if len(heights) != 1:
        fault = "two columns of height" if heights else "no column of height"
        raise WaypointError(f"{place}: has {fault}, needs the columns {_EXAMPLE}.")
    return found[0], heights[0]
