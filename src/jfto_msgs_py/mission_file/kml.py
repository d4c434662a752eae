"""KML: points, else the corners of lines and tracks, in the order of the document.

Read element by element, not through GDAL: its drivers sort by layer, and the older of them drops
altitude modes.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from xml.etree import ElementTree as ET

from jfto_msgs_py.mission_file.document import MissionTextError
from jfto_msgs_py.mission_file.other_names import ANGLES, angles, not_used, switched_off
from jfto_msgs_py.mission_file.points import Above, FilePoint, PointDocument, number
from jfto_msgs_py.mission_file.safe_xml import all_of, child, local, parse_xml, text_of

_MODES = {
    "absolute": Above.SEA_LEVEL,
    "relativeToGround": Above.GROUND,
    "clampToGround": Above.CLAMPED,
}
_SEA_FLOOR = ("relativeToSeaFloor", "clampToSeaFloor")
_POINTS, _LINES, _AREAS = ("Point",), ("LineString", "Track"), ("Polygon",)
_NOT_READ = ("GroundOverlay", "PhotoOverlay", "ScreenOverlay", "NetworkLink", "Model", "LookAt")
# What makes a KML one of DJI's, whose places mean something else.
_DJI = "wpmz"


def read_kml(data: bytes, source: str) -> PointDocument:
    """Points of a KML; where it has none, corners of its lines. Raises MissionTextError."""
    root = parse_xml(data, source)
    if local(root.tag) not in ("kml", "Document", "Folder", "Placemark"):
        raise MissionTextError(
            f"{source}: is not KML: begins with <{local(root.tag)[:40]}>. Export it as KML."
        )
    if any(_DJI in one.tag for one in root.iter() if isinstance(one.tag, str)):
        raise MissionTextError(
            f"{source}: is the template of a DJI wayline, which only DJI's programs lay out. Give "
            "the whole .kmz with wpmz/waylines.wpml."
        )
    return _Reader(source).read(root)


class _Reader:
    def __init__(self, source: str) -> None:
        self._source = source
        self._names: set[str] = set()
        self._left_out = 0
        self._again = 0

    def read(self, root: ET.Element) -> PointDocument:
        marks = list(enumerate(all_of(root, "Placemark"), start=1))
        kinds = Counter(local(one.tag) for one in root.iter())
        wanted = next((k for k in (_POINTS, _LINES) if any(kinds[name] for name in k)), ())
        if not wanted:
            raise MissionTextError(self._nothing(kinds))
        found = [point for k, mark in marks for point in self._mark(mark, k, wanted)]
        notes = not_used(self._source, self._names, ANGLES)
        rest = [
            f"{name} × {kinds[name]}"
            for name in (*_LINES, *_AREAS, *_NOT_READ)
            if kinds[name] and name not in wanted
        ]
        if rest:
            notes.append(f"{self._source}: not used: {', '.join(rest)}")
        if self._left_out:
            notes.append(f"{self._source}: {self._left_out} points without a photo are left out")
        if self._again:
            notes.append(
                f"{self._source}: {self._again} corners at a place met before are left out"
            )
        return PointDocument(tuple(found), tuple(notes))

    def _nothing(self, kinds: Counter[str]) -> str:
        if kinds["Polygon"]:
            return (
                f"{self._source}: holds areas only ({kinds['Polygon']} polygons), waypoints are "
                "points or lines. To photograph the area, set waypoints.source to coverage and "
                "area.file to this file."
            )
        return (
            f"{self._source}: holds no point and no line. Draw waypoints as placemarks or as a "
            "path, and export them."
        )

    def _mark(self, mark: ET.Element, index: int, wanted: tuple[str, ...]) -> Iterator[FilePoint]:
        name = text_of(mark, "name")
        place = f"{self._source}, placemark {index}" + (f" ({name[:40]})" if name else "")
        data = self._data(mark, place)
        shapes = [one for one in mark.iter() if local(one.tag) in wanted]
        for shape in shapes:
            corners = list(self._corners(shape, place))
            if switched_off(data):
                self._left_out += len(corners)
                continue
            above = self._above(shape, place)
            if wanted == _LINES:
                # A line that comes by a corner again, as closed ones do, has one waypoint there.
                once = list(dict.fromkeys(corners))
                self._again += len(corners) - len(once)
                corners = once
            many = len(corners) > 1 or len(shapes) > 1
            for number_, (lon, lat, alt) in enumerate(corners, start=1):
                where = f"{place}, point {number_}" if many else place
                yield FilePoint(where, (lat, lon), alt, above, *angles(data, where))

    def _data(self, mark: ET.Element, place: str) -> dict[str, str]:
        """What a placemark carries by name, and where its camera looks."""
        found: dict[str, str] = {}
        for one in mark.iter():
            kind, name = local(one.tag), one.get("name")
            if name and kind == "Data":
                found[name.strip().lower()] = text_of(one, "value") or ""
            elif name and kind == "SimpleData":
                found[name.strip().lower()] = (one.text or "").strip()
        self._names |= {name for name in found if name not in ("take_photo", "photo")}
        camera = child(mark, "Camera")
        if camera is not None and not ANGLES & set(found):
            found["heading"] = text_of(camera, "heading") or "0"
            # The tilt of a camera is 0 straight down and 90 at the horizon.
            tilt = number(text_of(camera, "tilt") or "0", "tilt", place)
            found["pitch"] = repr(tilt - 90.0)
        return found

    def _above(self, shape: ET.Element, place: str) -> Above:
        # Google's own altitude modes stand in its own namespace, under the same name.
        mode = text_of(shape, "altitudeMode") or "clampToGround"
        if mode in _SEA_FLOOR or mode not in _MODES:
            raise MissionTextError(
                f"{place}: altitudeMode is {mode[:40]!r}, which is not read. Use absolute or "
                "relativeToGround."
            )
        return _MODES[mode]

    def _corners(self, shape: ET.Element, place: str) -> Iterator[tuple[float, float, float]]:
        """Longitude, latitude and height of each corner."""
        if local(shape.tag) == "Track":
            texts = [(one.text or "").split() for one in shape if local(one.tag) == "coord"]
        else:
            texts = [part.split(",") for part in (text_of(shape, "coordinates") or "").split()]
        if not texts:
            raise MissionTextError(f"{place}: its {local(shape.tag)} has no coordinates. Draw it.")
        for parts in texts:
            if not 2 <= len(parts) <= 3:
                raise MissionTextError(
                    f"{place}: coordinates are {','.join(parts)[:60]!r}, must be "
                    "longitude,latitude,altitude without blanks between."
                )
            lon, lat = (number(parts[k], name, place) for k, name in _AXES)
            yield lon, lat, number(parts[2], "altitude", place) if len(parts) == 3 else 0.0


_AXES = ((0, "longitude"), (1, "latitude"))
