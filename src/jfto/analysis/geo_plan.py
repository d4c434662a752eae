"""Plans and waypoints in degrees and metres above sea level, for files of other programs."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from jfto_msgs_py.errors import InputError
from jfto_msgs_py.files import write_file
from jfto_msgs_py.mission_file import FORMATS, Format, GeoArea, GeoPlan, GeoRoute, GeoStop
from jfto_msgs_py.mission_file.geo_plan import Position
from jfto_msgs_py.records.plan import Plan, Waypoint
from jfto_msgs_py.records.site import Ring, Zone
from jfto_msgs_py.types import Array
from jfto_world.terrain import Dem, LocalFrame

if TYPE_CHECKING:
    from jfto.planning.survey import Survey

_CIRCLE_CORNERS = 72


class _Globe:
    """From a plan's local metres to degrees and heights above sea level."""

    def __init__(self, frame: LocalFrame, dem: Dem | None) -> None:
        self._frame, self._dem = frame, dem

    def positions(self, points_m: ArrayLike) -> list[Position]:
        """Latitude, longitude and height of points (K, 3)."""
        lat, lon, alt = self._frame.to_geodetic(np.asarray(points_m).reshape(-1, 3))
        return [(float(a), float(b), float(c)) for a, b, c in zip(lat, lon, alt, strict=True)]

    def ring(self, ring: Ring) -> tuple[tuple[float, float], ...]:
        """Latitude and longitude of corners."""
        return tuple((lat, lon) for lat, lon, _ in self.positions([(*one, 0.0) for one in ring]))

    def height(self, at_m: tuple[float, float], up_m: float | None) -> float | None:
        """Height above sea level of a height at a place; None stays without limit."""
        return None if up_m is None else self.positions([(*at_m, up_m)])[0][2]

    def above_ground(self, points_m: Array) -> list[float | None]:
        """Heights above ground, None where it is unknown."""
        dem = self._dem
        if dem is None or not dem.contains(points_m[:, 0], points_m[:, 1]).all():
            return [None] * len(points_m)
        return [float(v) for v in points_m[:, 2] - dem.height(points_m[:, 0], points_m[:, 1])]


def geo_plan_of(plan: Plan, dem: Dem | None, name: str, drone: str = "") -> GeoPlan:
    """A plan as it is written into files of other programs; `dem` is its terrain where known."""
    place = _Globe(LocalFrame(plan.origin), dem)
    by_id = {waypoint.id: waypoint for waypoint in plan.waypoints}
    routes = []
    for index, (uav, route) in enumerate(zip(plan.uavs, plan.routes, strict=True)):
        waypoints = [by_id[number] for number in route.waypoint_ids]
        way = plan.homes[index].points_m if plan.homes else ()
        (home,) = place.positions([uav.start_m])
        stops = _stops(waypoints, place, route.arrival_s)
        way_home = tuple(place.positions(way)) if way else ()
        routes.append(GeoRoute(uav.id, stops, home, way_home, uav.speed_mps))
    fence = plan.fence
    return GeoPlan(
        name,
        tuple(routes),
        tuple(
            GeoArea(f"area {k}", place.ring(part.outer), tuple(map(place.ring, part.holes)))
            for k, part in enumerate(plan.area, start=1)
        ),
        tuple(
            GeoArea(f"keep in {k}", place.ring(part.outer), tuple(map(place.ring, part.holes)))
            for k, part in enumerate(fence.keep_in if fence else (), start=1)
        ),
        tuple(_zone(zone, place) for zone in (fence.keep_out if fence else ())),
        drone,
    )


def geo_waypoints_of(found: Survey, name: str) -> GeoPlan:
    """Waypoints that nobody flies yet."""
    place = _Globe(found.dem.frame, found.dem)
    return GeoPlan(name, (GeoRoute("", _stops(found.waypoints, place)),))


def _stops(
    waypoints: Sequence[Waypoint], place: _Globe, arrival_s: Sequence[float] = ()
) -> tuple[GeoStop, ...]:
    points = np.array([waypoint.position_m for waypoint in waypoints]).reshape(-1, 3)
    times: Sequence[float | None] = arrival_s or [None] * len(waypoints)
    return tuple(
        GeoStop(w.id, at, w.yaw_deg, w.pitch_deg, w.photo, above_m, time_s)
        for w, at, above_m, time_s in zip(
            waypoints, place.positions(points), place.above_ground(points), times, strict=True
        )
    )


def _zone(zone: Zone, place: _Globe) -> GeoArea:
    """A zone as a polygon; that of a circle lies outside of it."""
    corners, middle = zone.outer, zone.centre_m
    if zone.radius_m > 0:
        turns = np.arange(_CIRCLE_CORNERS) * 2 * math.pi / _CIRCLE_CORNERS
        radius_m = zone.radius_m / math.cos(math.pi / _CIRCLE_CORNERS)
        corners = tuple(
            (middle[0] + radius_m * math.cos(turn), middle[1] + radius_m * math.sin(turn))
            for turn in turns
        )
    else:
        middle = corners[0]
    bottom_m, top_m = (place.height(middle, each) for each in (zone.bottom_m, zone.top_m))
    return GeoArea(zone.name, place.ring(corners), (), bottom_m, top_m)


def format_of(path: Path) -> Format:
    """The format in which waypoints are written under a name. Raises InputError."""
    writable = [form for form in FORMATS if form.write is not None and not form.per_uav]
    for form in writable:
        if path.suffix.lower() in form.suffixes:
            return form
    known = ", ".join(form.suffixes[0] for form in writable)
    raise InputError(f"{path}: is no known format. Name it {known}.")


def write_waypoints(found: Survey, path: Path) -> None:
    """Write place, height and view of every waypoint; raises InputError."""
    write = format_of(path).write
    assert write is not None
    write_file(path, write(geo_waypoints_of(found, path.stem)))
