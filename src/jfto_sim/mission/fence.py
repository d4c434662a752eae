"""Fences: whether a list of items makes whole figures, and which fence the vehicle has crossed."""

from __future__ import annotations

import math

from jfto_sim.geodesy import offset_m
from jfto_sim.mission.items import FENCE, Item, Store
from jfto_sim.parameters import Parameters

POLYGON_IN, POLYGON_OUT, CIRCLE_IN, CIRCLE_OUT, RETURN_POINT = 5001, 5002, 5003, 5004, 5000
_CORNERS_MIN, _CORNERS_MAX = 3, 255
ALT_MAX, CIRCLE, POLYGON, ALT_MIN = 1, 2, 4, 8


def fence_fault(items: list[Item]) -> str:
    """What keeps fence items from making whole figures, empty if they do."""
    left, kind, size = 0, 0, 0.0
    for item in items:
        if item.command in (POLYGON_IN, POLYGON_OUT):
            if left == 0:
                size = item.params[0]
                if not _CORNERS_MIN <= size <= _CORNERS_MAX:
                    return f"Invalid vertex count ({size:.0f})"
                left, kind = int(size), item.command
            elif item.command != kind or item.params[0] != size:
                return "Unexpected vertex"
            left -= 1
        elif left or item.command not in (CIRCLE_IN, CIRCLE_OUT, RETURN_POINT):
            return "Unexpected fence item"
    return "Incomplete polygon" if left else ""


def fence_size(items: list[Item]) -> int:
    """FENCE_TOTAL: the corners and circles, and two more for each polygon."""
    polygons = sum(1.0 / i.params[0] for i in items if i.command in (POLYGON_IN, POLYGON_OUT))
    return len(items) + 2 * round(polygons)


def breach(
    params: Parameters,
    store: Store,
    from_home_m: tuple[float, float, float],
    origin: tuple[int, int],
) -> int:
    """Bit mask of the fences crossed: 1 ceiling, 2 circle, 4 figures, 8 floor.

    `from_home_m` is (east, north, up) of home; `origin` is home in 1e-7 degree.
    """
    enabled = int(params["FENCE_TYPE"])
    east, north, up = from_home_m
    found = 0
    if enabled & ALT_MAX and up >= params["FENCE_ALT_MAX"]:
        found |= ALT_MAX
    if enabled & ALT_MIN and up <= params["FENCE_ALT_MIN"]:
        found |= ALT_MIN
    if enabled & CIRCLE and math.hypot(east, north) >= params["FENCE_RADIUS"]:
        found |= CIRCLE
    if enabled & POLYGON and _outside_figures(store, (east, north), origin):
        found |= POLYGON
    return found


def _outside_figures(store: Store, at_m: tuple[float, float], origin: tuple[int, int]) -> bool:
    items = store.lists[FENCE]
    k = 0
    while k < len(items):
        item = items[k]
        east, north = offset_m(*origin, item.x, item.y)
        if item.command in (CIRCLE_IN, CIRCLE_OUT):
            inside = math.hypot(at_m[0] - east, at_m[1] - north) <= item.params[0]
            if inside != (item.command == CIRCLE_IN):
                return True
            k += 1
        elif item.command in (POLYGON_IN, POLYGON_OUT):
            size = int(item.params[0])
            corners = [offset_m(*origin, i.x, i.y) for i in items[k : k + size]]
            if _inside(at_m, corners) != (item.command == POLYGON_IN):
                return True
            k += size
        else:
            k += 1
    return False


def _inside(at_m: tuple[float, float], corners: list[tuple[float, float]]) -> bool:
    """Even-odd rule."""
    inside = False
    for k, (x1, y1) in enumerate(corners):
        x0, y0 = corners[k - 1]
        if (y1 > at_m[1]) != (y0 > at_m[1]):
            crossing = x1 + (at_m[1] - y1) * (x0 - x1) / (y0 - y1)
            if at_m[0] < crossing:
                inside = not inside
    return inside
