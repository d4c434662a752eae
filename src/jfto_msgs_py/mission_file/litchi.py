"""Litchi's mission table, as the items of a mission that does the same.

Columns are those that Litchi's Mission Hub exports, in metres or in feet. Heights are above the
place of take-off (which the table does not name) or above ground.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator

from jfto_msgs_py.mission_file import mission_items as do
from jfto_msgs_py.mission_file.csv_points import UNITS_M
from jfto_msgs_py.mission_file.document import FileItem, MissionDocument, MissionTextError
from jfto_msgs_py.mission_file.table import Row, Table

_LITCHIS_OWN = {"gimbalmode", "curvesize_m", "curvesize_ft", "actiontype1", "rotationdir"}
_FRAMES = {0: do.ABOVE_HOME, 1: do.ABOVE_GROUND}
_GIMBAL_OFF, _GIMBAL_POI, _GIMBAL_ANGLE = 0, 1, 2
_NO_ACTION, _STAY, _PHOTO, _RECORD, _STOP_RECORD, _TURN, _TILT = range(-1, 6)
_PASSED = {_STAY: "waiting", _RECORD: "start of a video", _STOP_RECORD: "end of a video"}
_ACTIONS = 15
_SPEEDS = {"m_s": 1.0, "mps": 1.0, "km_h": 1 / 3.6, "kph": 1 / 3.6, "mph": 0.44704, "ft_s": 0.3048}
_USED = {
    "latitude", "longitude", "heading_deg", "heading", "gimbalmode", "gimbalpitchangle",
    "altitudemode", "poi_latitude", "poi_longitude", "poi_altitudemode", "photo_timeinterval",
    "photo_distinterval", "rotationdir",
    *(f"{name}{k}" for name in ("actiontype", "actionparam") for k in range(1, _ACTIONS + 1)),
}  # fmt: skip


def is_litchi(table: Table) -> bool:
    """Whether a table is Litchi's, by columns that only it has."""
    return len(_LITCHIS_OWN & set(table.header)) >= 2


def read_litchi(table: Table) -> MissionDocument:
    """The mission of a table. Raises MissionTextError."""
    return _Reader(table).read()


class _Reader:
    def __init__(self, table: Table) -> None:
        self._table = table
        self._altitude, self._unit = self._column("altitude", UNITS_M, needed=True)
        self._poi_altitude, self._poi_unit = self._column("poi_altitude", UNITS_M)
        self._speed, self._speed_unit = self._column("speed", _SPEEDS)
        self._heading = "heading_deg" if "heading_deg" in table.header else "heading"
        for name in ("latitude", "longitude", self._heading):
            if name not in table.header:
                raise MissionTextError(
                    f"{table.source}, line 1: has no column {name}. Export it from Litchi again."
                )
        table.once({"latitude", "longitude", self._heading, self._altitude})
        self._passed: Counter[str] = Counter()
        self._off = 0
        self._interval = (0.0, 0.0)
        self._speed_mps = 0.0

    def _column(
        self, base: str, units: dict[str, float], *, needed: bool = False
    ) -> tuple[str, float]:
        """Name and unit of a column that carries its unit; ("", 1) where there is none."""
        place = f"{self._table.source}, line 1"
        for name in self._table.header:
            if name == base or name.startswith(f"{base}_"):
                unit = name[len(base) + 1 :]
                if unit == "" and "" not in units:
                    unit = next(iter(units))
                if unit in units:
                    return name, units[unit]
                if not any(name.startswith(f"{base}{other}") for other in ("mode", "_mode")):
                    raise MissionTextError(
                        f"{place}: {base} is in {unit!r}, a unit that is not known. Use "
                        f"{', '.join(filter(None, units))}."
                    )
        if needed:
            raise MissionTextError(
                f"{place}: has no column {base}(m). Export it from Litchi again."
            )
        return "", 1.0

    def read(self) -> MissionDocument:
        items = tuple(item for row in self._table.rows for item in self._row(row))
        source, notes = self._table.source, []
        used = {*_USED, self._altitude, self._poi_altitude, self._speed}
        rest = sorted(name for name in self._table.header if name not in used)
        told = [*rest, *(f"{name} × {count}" for name, count in self._passed.items())]
        if told:
            notes.append(f"{source}: not used: {', '.join(told)}")
        if self._off:
            notes.append(
                f"{source}: {self._off} waypoints leave the gimbal as it is (gimbalmode 0): taken "
                "as straight down, unless an action tilts it"
            )
        return MissionDocument(items, None, notes=tuple(notes), home_unnamed_by="Litchi")

    def _whole(self, row: Row, column: str, known: tuple[int, ...], default: int) -> int:
        told = row.cells.get(column, "")
        if not told:
            return default
        value = row.number(column)
        if value not in known:
            raise MissionTextError(
                f"{row.place}: {column} is {told[:20]}, known are {', '.join(map(str, known))}. "
                "Export it from Litchi again."
            )
        return int(value)

    def _given(self, row: Row, column: str) -> float:
        """A number, 0 where the table has no such column or leaves it empty."""
        return row.number(column) if row.cells.get(column) else 0.0

    def _row(self, row: Row) -> Iterator[FileItem]:
        place = row.place
        frame = _FRAMES[self._whole(row, "altitudemode", (0, 1), 0)]
        mps = self._given(row, self._speed) * self._speed_unit
        if mps > 0 and mps != self._speed_mps:
            self._speed_mps = mps
            yield do.speed(place, mps)
        yield do.heading(place, row.number(self._heading))
        yield from self._gimbal(row)
        where = (row.number("latitude"), row.number("longitude"))
        yield do.waypoint(place, frame, (*where, row.number(self._altitude) * self._unit))
        for k in range(1, _ACTIONS + 1):
            yield from self._action(row, k)
        yield from self._often(row)

    def _gimbal(self, row: Row) -> Iterator[FileItem]:
        mode = self._whole(row, "gimbalmode", (_GIMBAL_OFF, _GIMBAL_POI, _GIMBAL_ANGLE), 0)
        if mode == _GIMBAL_POI:
            frame = _FRAMES[self._whole(row, "poi_altitudemode", (0, 1), 0)]
            poi = (self._given(row, "poi_latitude"), self._given(row, "poi_longitude"))
            if not any(poi):
                raise MissionTextError(
                    f"{row.place}: gimbalmode is 1, but poi_latitude and poi_longitude name no "
                    "place. Set the point of interest, or a gimbal angle (gimbalmode 2)."
                )
            yield do.look_at(
                row.place, frame, (*poi, self._given(row, self._poi_altitude) * self._poi_unit)
            )
            return
        yield do.look_ahead(row.place)
        if mode == _GIMBAL_ANGLE:
            yield do.pitch(row.place, row.number("gimbalpitchangle"))
        else:
            self._off += 1

    def _action(self, row: Row, k: int) -> Iterator[FileItem]:
        known = tuple(range(_NO_ACTION, _TILT + 1))
        kind = self._whole(row, f"actiontype{k}", known, _NO_ACTION)
        if kind == _PHOTO:
            yield do.shoot(row.place)
        elif kind == _TURN:
            yield do.heading(row.place, row.number(f"actionparam{k}"))
        elif kind == _TILT:
            yield do.pitch(row.place, row.number(f"actionparam{k}"))
        elif kind in _PASSED:
            self._passed[_PASSED[kind]] += 1

    def _often(self, row: Row) -> Iterator[FileItem]:
        """Photos by distance or time from this waypoint on."""
        asked = tuple(
            max(self._given(row, name), 0.0)
            for name in ("photo_distinterval", "photo_timeinterval")
        )
        distance_m, interval_s = asked[0] * self._unit, asked[1]
        if (distance_m, interval_s) == self._interval:
            return
        self._interval = (distance_m, interval_s)
        if distance_m > 0:
            yield do.every_metres(row.place, distance_m)
        elif interval_s > 0:
            yield do.every_seconds(row.place, interval_s)
        else:
            yield do.no_more(row.place)
