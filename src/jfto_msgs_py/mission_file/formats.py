"""Every format of waypoints and missions: its names, and what reads it."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from jfto_msgs_py.errors import InputError
from jfto_msgs_py.mission_file.csv_points import read_csv
from jfto_msgs_py.mission_file.document import MissionDocument, MissionTextError
from jfto_msgs_py.mission_file.geo_plan import GeoPlan
from jfto_msgs_py.mission_file.geojson import read_geojson
from jfto_msgs_py.mission_file.kml import read_kml
from jfto_msgs_py.mission_file.litchi import is_litchi, read_litchi
from jfto_msgs_py.mission_file.points import PointDocument
from jfto_msgs_py.mission_file.read import PLAN_SUFFIX, WPL_SUFFIXES, read_document
from jfto_msgs_py.mission_file.safe_xml import LARGEST_BYTES, members, read_bytes
from jfto_msgs_py.mission_file.table import read_table
from jfto_msgs_py.mission_file.wpml import WAYLINES, read_waylines
from jfto_msgs_py.mission_file.write_kml import write_kml, write_kmz
from jfto_msgs_py.mission_file.write_litchi import write_litchi
from jfto_msgs_py.mission_file.write_points import write_csv, write_geojson
from jfto_msgs_py.mission_file.write_wpml import write_wpml
from jfto_msgs_py.text_encoding import read_foreign_text

Document = PointDocument | MissionDocument


@dataclass(frozen=True)
class Format:
    """One format: `key` names it on a command line, `suffixes` its files, the first when written.

    Formats that share a suffix share `read`, which tells them apart by content. `write` is None
    where missions are written elsewhere (`jfto_mavlink.files`); `per_uav` is whether a file holds
    one route only.
    """

    key: str
    name: str
    suffixes: tuple[str, ...]
    read: Callable[[Path], Document]
    write: Callable[[GeoPlan], bytes] | None = None
    per_uav: bool = False


def read_any(path: Path) -> Document:
    """What a file of waypoints or a mission holds, by its suffix and its content.

    Parameters
    ----------
    path
        A file with one of the suffixes of `FORMATS`.

    Returns
    -------
    PointDocument or MissionDocument
        Places one by one, or items of a mission, with notes on what is not used.

    Raises
    ------
    MissionTextError
        Names file, line or item, reason and cure.
    """
    suffix = path.suffix.lower()
    for form in FORMATS:
        if suffix in form.suffixes:
            return form.read(path)
    known = ", ".join(f"{form.name} ({form.suffixes[0]})" for form in FORMATS)
    raise MissionTextError(f"{path} is of no known waypoint format. Use {known}.")


def _read_csv(path: Path) -> Document:
    def read(text: str) -> Document:
        table = read_table(text, str(path))
        return read_litchi(table) if is_litchi(table) else read_csv(table)

    return _of_text(path, "CSV", read)


def _read_geojson(path: Path) -> Document:
    return _of_text(path, "GeoJSON", lambda text: read_geojson(text, str(path)))


def _read_kml(path: Path) -> Document:
    return read_kml(read_bytes(path, "KML"), str(path))


def _read_wpml(path: Path) -> Document:
    return read_waylines({WAYLINES: read_bytes(path, "WPML")}, str(path))


def _read_kmz(path: Path) -> Document:
    parts = members(read_bytes(path, "KMZ"), str(path))
    if any("wpmz" in name.lower() or name.lower().endswith(".wpml") for name in parts):
        return read_waylines(parts, str(path))
    # The first one counts, by the format's rule.
    for name, data in parts.items():
        found = read_kml(data, f"{path}, {name}")
        rest = [other for other in parts if other != name]
        notes = (f"{path}: not used: {', '.join(rest)[:200]}",) if rest else ()
        return dataclasses.replace(found, notes=(*notes, *found.notes))
    raise MissionTextError(f"{path}: holds no .kml. Export it again.")


def _of_text(path: Path, name: str, read: Callable[[str], Document]) -> Document:
    try:
        text, encoding = read_foreign_text(path, name, LARGEST_BYTES)
    except InputError as error:
        raise MissionTextError(str(error)) from None
    if not text.strip():
        raise MissionTextError(f"{path} is empty. Write one waypoint or more into it.")
    if not encoding:
        return read(text)
    try:
        found = read(text)
    except MissionTextError as error:
        raise MissionTextError(
            f"{error} It is not in UTF-8 and was read as {encoding.upper()}; if that is wrong, "
            "save it in UTF-8."
        ) from None
    told = f"{path}: is not in UTF-8, read as {encoding.upper()}"
    return dataclasses.replace(found, notes=(*found.notes, told))


FORMATS = (
    Format("csv", "CSV", (".csv",), _read_csv, write_csv),
    Format("geojson", "GeoJSON", (".geojson", ".json"), _read_geojson, write_geojson),
    Format("kml", "KML", (".kml",), _read_kml, write_kml),
    Format("kmz", "KMZ", (".kmz",), _read_kmz, write_kmz),
    Format("wpml", "DJI's waylines", (".kmz",), _read_kmz, write_wpml, per_uav=True),
    Format("wpml", "DJI's waylines", (".wpml",), _read_wpml),
    Format("litchi", "Litchi's CSV", (".csv",), _read_csv, write_litchi, per_uav=True),
    Format("plan", "QGroundControl's plan", (PLAN_SUFFIX,), read_document, per_uav=True),
    Format("waypoints", "Mission Planner's waypoints", WPL_SUFFIXES, read_document, per_uav=True),
)
