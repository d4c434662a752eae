"""Waypoints as a table: place, height with its reference and unit, heading and pitch."""

from __future__ import annotations

import re

from jfto_msgs_py.mission_file.document import MissionTextError
from jfto_msgs_py.mission_file.other_names import ANGLES, angles, not_used, switched_off
from jfto_msgs_py.mission_file.points import Above, FilePoint, PointDocument
from jfto_msgs_py.mission_file.table import Row, Table

_LOCAL = (("x_m", "east_m"), ("y_m", "north_m"))
_LATITUDE = ("lat", "latitude", "lat_deg", "latitude_deg")
_LONGITUDE = ("lon", "lng", "long", "longitude", "lon_deg", "lng_deg", "longitude_deg")
UNITS_M = {
    **dict.fromkeys(("", "m", "metre", "metres", "meter", "meters"), 1.0),
    **dict.fromkeys(("ft", "foot", "feet"), 0.3048),
    "us_ft": 1200 / 3937,
}
_OTHER_UNITS = ("yd", "yards", "km", "mi", "nm", "cm", "mm", "inch", "fl")
# Names of columns of height, without their unit.
_HEIGHTS = {
    **dict.fromkeys(("z", "alt", "altitude", "height", "elevation", "ele"), Above.UNSAID),
    **dict.fromkeys(
        ("amsl", "msl", "alt_amsl", "altitude_amsl", "alt_msl", "altitude_msl"), Above.SEA_LEVEL
    ),
    **dict.fromkeys(
        ("agl", "alt_agl", "altitude_agl", "height_agl", "above_ground", "height_above_ground"),
        Above.GROUND,
    ),
    **dict.fromkeys(
        ("above_home", "height_above_home", "above_takeoff", "height_above_takeoff",
         "relative_alt", "relative_altitude", "rel_alt"),
        Above.HOME,
    ),
    **dict.fromkeys(
        ("ellipsoid", "alt_ellipsoid", "height_ellipsoid", "ellipsoid_height",
         "ellipsoidal_height", "hae", "alt_hae", "altitude_hae"),
        Above.ELLIPSOID,
    ),
}  # fmt: skip
_REFERENCE = ("height_reference", "altitude_reference", "alt_reference", "height_ref",
              "altitude_mode", "altitudemode", "alt_mode", "vertical_datum")  # fmt: skip
_REFERENCES = {
    **dict.fromkeys(("amsl", "msl", "sea level", "absolute", "egm96", "egm2008"), Above.SEA_LEVEL),
    **dict.fromkeys(("agl", "ground", "above ground", "terrain"), Above.GROUND),
    **dict.fromkeys(("home", "above home", "takeoff", "take off", "relative"), Above.HOME),
    **dict.fromkeys(("ellipsoid", "ellipsoidal", "hae", "wgs84", "wgs 84"), Above.ELLIPSOID),
}
_EXAMPLE = (
    "lat,lon,alt or x_m,y_m,z_m; in place of the height also agl_m, amsl_m, above_home_m or "
    "ellipsoid_m, each also in _ft"
)


def read_csv(table: Table) -> PointDocument:
    """The points of a table; those whose take_photo is false are left out.

    Raises MissionTextError.
    """
    columns = _Columns(table)
    points = [columns.point(row) for row in table.rows]
    kept = tuple(point for point in points if point is not None)
    notes = not_used(table.source, table.header, {*columns.used, *ANGLES})
    if left_out := len(points) - len(kept):
        notes.append(f"{table.source}: {left_out} points without a photo are left out")
    return PointDocument(kept, tuple(notes))


class _Columns:
    """Which columns of a table hold place and height."""

    def __init__(self, table: Table) -> None:
        header, place = table.header, f"{table.source}, line 1"
        local = [next((n for n in names if n in header), "") for names in _LOCAL]
        globe = [next((n for n in names if n in header), "") for names in (_LATITUDE, _LONGITUDE)]
        if all(local) == all(globe):
            raise MissionTextError(
                f"{place}: the header is {table.separator.join(header)[:120]!r}, needs the columns "
                f"{_EXAMPLE}."
            )
        self._local = all(local)
        self._at = local if self._local else globe
        self._reference = next((name for name in _REFERENCE if name in header), "")
        self._heights = {n: known for n in header if (known := _height(n, place)) is not None}
        for name in header:
            if name.endswith("_rad") and {name[:-4], f"{name[:-4]}_deg"} & ANGLES:
                raise MissionTextError(f"{place}: {name} is in radians. Give it in degrees.")
        table.once({*self._at, self._reference, *self._heights, *ANGLES})
        if not self._heights:
            raise MissionTextError(
                f"{place}: has no column of height, needs the columns {_EXAMPLE}."
            )
        if len(self._heights) > 1 and not self._reference:
            raise MissionTextError(
                f"{place}: has two columns of height, {' and '.join(sorted(self._heights)[:2])}. "
                "Leave one, or say in a column height_reference which one counts."
            )
        self.used = {*self._at, self._reference, "take_photo", "photo"}

    def point(self, row: Row) -> FilePoint | None:
        if switched_off(row.cells):
            return None
        first, second = (row.number(name) for name in self._at)
        column, above = self._height_of(row)
        self.used.add(column)
        height_m = row.number(column) * self._heights[column][1]
        return FilePoint(
            row.place,
            (first, second),
            height_m,
            above,
            *angles(row.cells, row.place),
            local=self._local,
        )

    def _height_of(self, row: Row) -> tuple[str, Above]:
        """Which column of height counts in a row, and what it is above."""
        told = row.cells.get(self._reference, "")
        if not told:
            if len(self._heights) > 1:
                raise MissionTextError(
                    f"{row.place}: {self._reference} is empty. Write amsl, agl, home or ellipsoid."
                )
            ((name, (above, _)),) = self._heights.items()
            return name, above
        above = reference(told, self._reference, row.place)
        fitting = [n for n, (own, _) in self._heights.items() if own == above]
        open_ = [n for n, (own, _) in self._heights.items() if own == Above.UNSAID]
        # A bare "alt" is what the reference speaks of; other columns name their own.
        for names in (open_, fitting):
            if len(names) == 1:
                return names[0], above
        raise MissionTextError(
            f"{row.place}: {self._reference} is {told[:30]!r}, but the columns of height are "
            f"{', '.join(self._heights)}. Give one named alt, or the one that is meant."
        )


def reference(told: str, column: str, place: str) -> Above:
    """What a height is above, by the words of a file. Raises MissionTextError."""
    words = re.sub(r"[\s_\-]+", " ", told.strip().lower())
    if words not in _REFERENCES:
        raise MissionTextError(
            f"{place}: {column} is {told[:30]!r}, which is not known. Write amsl (above sea "
            "level), agl (above ground), home (above take-off) or ellipsoid."
        )
    return _REFERENCES[words]


def _height(column: str, place: str) -> tuple[Above, float] | None:
    """What a column of height is above and metres per unit; None where it is none."""
    for base in sorted(_HEIGHTS, key=len, reverse=True):
        if column == base or column.startswith(f"{base}_"):
            unit = column[len(base) + 1 :]
            if unit in _OTHER_UNITS:
                raise MissionTextError(
                    f"{place}: {column} is in {unit!r}, which is not read. Give it in m or ft."
                )
            return (_HEIGHTS[base], UNITS_M[unit]) if unit in UNITS_M else None
    return None
