"""Fence and rally points as shapes, and as the items that carry them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from jfto_mavlink.dialect import mavlink
from jfto_mavlink.errors import MissionError
from jfto_mavlink.protocol.item import FRAME_ABSOLUTE, FRAME_HOME, Item, at

Position = tuple[float, float]

_POLYGON = {
    True: mavlink.MAV_CMD_NAV_FENCE_POLYGON_VERTEX_INCLUSION,
    False: mavlink.MAV_CMD_NAV_FENCE_POLYGON_VERTEX_EXCLUSION,
}
_CIRCLE = {
    True: mavlink.MAV_CMD_NAV_FENCE_CIRCLE_INCLUSION,
    False: mavlink.MAV_CMD_NAV_FENCE_CIRCLE_EXCLUSION,
}
_RETURN = mavlink.MAV_CMD_NAV_FENCE_RETURN_POINT
FENCE_COMMANDS = frozenset((*_POLYGON.values(), *_CIRCLE.values(), _RETURN))
RALLY_COMMAND = mavlink.MAV_CMD_NAV_RALLY_POINT


@dataclass(frozen=True)
class Polygon:
    """A polygon to stay inside or outside of; vertices are latitude, longitude in degrees."""

    vertices: tuple[Position, ...]
    inclusion: bool = True


@dataclass(frozen=True)
class Circle:
    """A circle to stay inside or outside of."""

    center: Position
    radius_m: float
    inclusion: bool = True


@dataclass(frozen=True)
class Fence:
    """The shapes of a fence, and where to return to after a breach."""

    polygons: tuple[Polygon, ...] = ()
    circles: tuple[Circle, ...] = ()
    return_point: Position | None = None


@dataclass(frozen=True)
class RallyPoint:
    """A place to return to instead of home; ArduPilot keeps the height in whole metres."""

    position: Position
    height_m: float


def fence_items(fence: Fence) -> tuple[Item, ...]:
    """Items of a fence; raises MissionError for shapes that ArduPilot refuses to load."""
    items: list[Item] = []
    for polygon in fence.polygons:
        count = len(polygon.vertices)
        if count < 3:
            raise MissionError(301, f"fence polygon has {count} vertices, needs at least 3.")
        command = _POLYGON[polygon.inclusion]
        items += [at(command, FRAME_ABSOLUTE, *v, 0.0, count) for v in polygon.vertices]
    for circle in fence.circles:
        if not circle.radius_m > 0:
            raise MissionError(301, f"fence circle has radius {circle.radius_m} m, must be > 0.")
        command = _CIRCLE[circle.inclusion]
        items.append(at(command, FRAME_ABSOLUTE, *circle.center, 0.0, circle.radius_m))
    if fence.return_point is not None:
        items.append(at(_RETURN, FRAME_ABSOLUTE, *fence.return_point, 0.0))
    return tuple(items)


def fence_from_items(items: Sequence[Item]) -> Fence:
    """Shapes of fence items; raises MissionError for an incomplete polygon or an odd circle."""
    polygons: list[Polygon] = []
    circles: list[Circle] = []
    return_point: Position | None = None
    inclusion_of = {command: inclusion for inclusion, command in _POLYGON.items()}
    circle_of = {command: inclusion for inclusion, command in _CIRCLE.items()}
    index = 0
    while index < len(items):
        item = items[index]
        if item.command in inclusion_of:
            count = 0 if math.isnan(item.params[0]) else int(item.params[0])
            group = items[index : index + count]
            same = all((i.command, i.params[0]) == (item.command, item.params[0]) for i in group)
            if count < 3 or len(group) != count or not same:
                raise MissionError(301, f"fence item {index}: its polygon is incomplete.")
            vertices = tuple((i.lat_deg, i.lon_deg) for i in group)
            if any(abs(lat) > 90 or abs(lon) > 180 for lat, lon in vertices):
                raise MissionError(301, f"fence item {index}: its polygon is not on Earth.")
            polygons.append(Polygon(vertices, inclusion_of[item.command]))
            index += count
            continue
        place = (item.lat_deg, item.lon_deg)
        if abs(place[0]) > 90 or abs(place[1]) > 180:
            raise MissionError(301, f"fence item {index}: {place} is not on Earth.")
        if item.command in circle_of:
            if not item.params[0] > 0:
                raise MissionError(
                    301, f"fence item {index}: its radius is {item.params[0]:g} m, must be > 0."
                )
            circles.append(Circle(place, item.params[0], circle_of[item.command]))
        elif item.command == _RETURN:
            if return_point is not None:
                raise MissionError(301, f"fence item {index}: is a second return point.")
            return_point = place
        else:
            raise MissionError(301, f"fence item {index}: command {item.command} is no fence.")
        index += 1
    return Fence(tuple(polygons), tuple(circles), return_point)


def rally_items(points: Sequence[RallyPoint]) -> tuple[Item, ...]:
    """Items of rally points, heights above home in whole metres."""
    return tuple(at(RALLY_COMMAND, FRAME_HOME, *p.position, round(p.height_m)) for p in points)
