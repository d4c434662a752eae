"""Writes a plan as KML or KMZ: waypoints with their view, routes, area and zones."""

from __future__ import annotations

from collections.abc import Iterable
from xml.etree import ElementTree as ET

from jfto_msgs_py.mission_file.build_xml import KML_SPACE, add, archive, as_bytes, lon_lat
from jfto_msgs_py.mission_file.geo_plan import GeoArea, GeoPlan, GeoRoute, GeoStop, Position, Ring

# aabbggrr, as KML has them.
_COLOURS = ("ffb4771f", "ff0e7fff", "ff2ca02c", "ff2827d6", "ffbd6794", "ff4b568c", "ffc277e3",
            "ff22bdbc", "ffcfbe17")  # fmt: skip
_AREA, _KEEP_IN, _KEEP_OUT = ("area", "7f00ff00"), ("keep in", "7fffaa00"), ("keep out", "7f0000ff")
# Zones without a top are drawn this high above all that is flown.
_ROOM_M = 50.0


def write_kml(plan: GeoPlan) -> bytes:
    """The KML document; heights are absolute, above sea level."""
    root = ET.Element("kml", xmlns=KML_SPACE)
    document = add(root, "Document")
    add(document, "name", plan.name)
    for index, _ in enumerate(plan.routes):
        colour = _COLOURS[index % len(_COLOURS)]
        style = add(document, "Style", id=f"route{index}")
        add(add(style, "IconStyle"), "color", colour)
        line = add(style, "LineStyle")
        add(line, "color", colour)
        add(line, "width", 3)
    for (name, colour), shapes in _shapes(plan):
        if shapes:
            style = add(document, "Style", id=name.replace(" ", "_"))
            add(add(style, "LineStyle"), "color", f"ff{colour[2:]}")
            add(add(style, "PolyStyle"), "color", colour)
    for index, route in enumerate(plan.routes):
        _route(document, route, f"#route{index}")
    top_m = max((s.at[2] for r in plan.routes for s in r.stops), default=0.0) + _ROOM_M
    for (name, _), shapes in _shapes(plan):
        if shapes:
            folder = add(document, "Folder")
            add(folder, "name", name)
            for shape in shapes:
                _shape(folder, shape, name, top_m)
    return as_bytes(root)


def write_kmz(plan: GeoPlan) -> bytes:
    """The same, packed."""
    return archive({"doc.kml": write_kml(plan)})


def _shapes(plan: GeoPlan) -> tuple[tuple[tuple[str, str], tuple[GeoArea, ...]], ...]:
    return ((_AREA, plan.area), (_KEEP_IN, plan.keep_in), (_KEEP_OUT, plan.keep_out))


def _coordinates(positions: Iterable[Position]) -> str:
    return " ".join(f"{lon_lat(lat, lon)},{alt:.3f}" for lat, lon, alt in positions)


def _route(document: ET.Element, route: GeoRoute, style: str) -> None:
    folder = add(document, "Folder")
    add(folder, "name", route.uav or "waypoints")
    line = [stop.at for stop in route.stops]
    if route.home is not None:
        pad = _mark(folder, f"{route.uav} pad", style, {"take_photo": "false"})
        point = add(pad, "Point")
        add(point, "altitudeMode", "absolute")
        add(point, "coordinates", _coordinates([route.home]))
        line = [route.home, *line, *route.way_home, *([route.home] if route.way_home else [])]
    if route.uav and len(line) > 1:
        mark = _mark(folder, f"{route.uav} route", style, {})
        shape = add(mark, "LineString")
        add(shape, "altitudeMode", "absolute")
        add(shape, "coordinates", _coordinates(line))
    for order, stop in enumerate(route.stops, start=1):
        _stop(folder, route, order, stop, style)


def _stop(folder: ET.Element, route: GeoRoute, order: int, stop: GeoStop, style: str) -> None:
    data = {"heading": f"{stop.yaw_deg:.6f}", "pitch": f"{stop.pitch_deg:.6f}"}
    if route.uav:
        data |= {"uav": route.uav, "order": str(order)}
    if stop.arrival_s is not None:
        data["arrival_s"] = f"{stop.arrival_s:.1f}"
    if not stop.photo:
        data["take_photo"] = "false"
    name = f"{route.uav} {stop.number}".strip()
    mark = _mark(folder, name, style, data, stop)
    point = add(mark, "Point")
    add(point, "altitudeMode", "absolute")
    add(point, "coordinates", _coordinates([stop.at]))


def _mark(
    folder: ET.Element, name: str, style: str, data: dict[str, str], seen: GeoStop | None = None
) -> ET.Element:
    """A placemark up to its geometry, in the order that KML's schema wants."""
    mark = add(folder, "Placemark")
    add(mark, "name", name)
    if seen is not None:
        # What a click shows in Google Earth is what the photo shows.
        camera = add(mark, "Camera")
        lat, lon, alt = seen.at
        for key, value in (
            ("longitude", f"{lon:.9f}"),
            ("latitude", f"{lat:.9f}"),
            ("altitude", f"{alt:.3f}"),
            ("heading", f"{seen.yaw_deg:.6f}"),
            ("tilt", f"{seen.pitch_deg + 90.0:.6f}"),
            ("altitudeMode", "absolute"),
        ):
            add(camera, key, value)
    add(mark, "styleUrl", style)
    if data:
        extended = add(mark, "ExtendedData")
        for key, value in data.items():
            add(add(extended, "Data", name=key), "value", value)
    return mark


def _shape(folder: ET.Element, shape: GeoArea, kind: str, top_m: float) -> None:
    mark = _mark(folder, shape.name, f"#{kind.replace(' ', '_')}", {})
    polygon = add(mark, "Polygon")
    is_zone = kind == _KEEP_OUT[0]
    if is_zone:
        add(polygon, "extrude", 0 if shape.bottom_m is not None else 1)
    add(polygon, "altitudeMode", "absolute" if is_zone else "clampToGround")
    height_m = (shape.top_m if shape.top_m is not None else top_m) if is_zone else 0.0
    for kind_of_ring, rings in (
        ("outerBoundaryIs", (shape.outer,)),
        ("innerBoundaryIs", shape.holes),
    ):
        for ring in rings:
            boundary = add(add(polygon, kind_of_ring), "LinearRing")
            add(boundary, "coordinates", _coordinates(_closed(ring, height_m)))


def _closed(ring: Ring, height_m: float) -> list[Position]:
    return [(lat, lon, height_m) for lat, lon in (*ring, *ring[:1])]
