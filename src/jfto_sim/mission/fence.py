"""Fences: whether a list of items makes whole figures, and which fence the vehicle has crossed."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from jfto_sim.mission.items import FENCE, Item, Store
from jfto_sim.parameters import Parameters
from jfto_sim.position import Position

POLYGON_IN, POLYGON_OUT, CIRCLE_IN, CIRCLE_OUT, RETURN_POINT = 5001, 5002, 5003, 5004, 5000
_CORNERS_MIN, _CORNERS_MAX = 3, 255
ALT_MAX, CIRCLE, POLYGON, ALT_MIN = 1, 2, 4, 8
_RECOVERY_S = 10.0
_AGAIN_M, _LOWEST_M, _FLOOR_OFF = 20.0, -100.0, 2.0


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


@dataclass
class Fence:
    """The vehicle's fences: what they forbid, and which of them is crossed (`breached`, a mask).

    `floor` says whether the floor is watched: only once a station or a mission has switched the
    fence on by command, and then until it is switched off.
    """

    params: Parameters
    store: Store
    position: Position
    floor: bool = False
    breached: int = 0
    unwatched_until_s: float = 0.0
    beyond_m: float = 0.0
    _again_at_m: dict[int, float] = field(default_factory=dict)

    @property
    def enabled(self) -> int:
        """Mask of the fences that count, 0 where the fence is off."""
        return int(self.params["FENCE_TYPE"]) if self.params["FENCE_ENABLE"] else 0

    @property
    def level(self) -> bool:
        """Whether a fence counts that needs a place on the globe."""
        return bool(self.enabled & (CIRCLE | POLYGON))

    @property
    def ceiling_m(self) -> float:
        """Height above home that the autopilot keeps on its own ways; infinite without ceiling."""
        if not self.enabled & ALT_MAX:
            return math.inf
        return self.params["FENCE_ALT_MAX"] - self.params["FENCE_MARGIN"]

    def switch(self, order: float) -> bool:
        """DO_FENCE_ENABLE: 0 off, 1 on with its floor, 2 the floor off; false for other orders."""
        if order in (0.0, 1.0):
            self.params.store("FENCE_ENABLE", order)
        elif order != _FLOOR_OFF:
            return False
        self.floor = order == 1.0
        return True

    def allows(self, place_m: tuple[float, float, float]) -> bool:
        """Whether GUIDED may be sent to metres east, north, up of the power-up point."""
        p, home = self.params, self.position.home_m
        level = (place_m[0] - home[0], place_m[1] - home[1])
        up = place_m[2] - home[2]
        if self.enabled & ALT_MAX and up > p["FENCE_ALT_MAX"]:
            return False
        if self.enabled & ALT_MIN and up < p["FENCE_ALT_MIN"]:
            return False
        if self.enabled & CIRCLE and math.hypot(*level) > p["FENCE_RADIUS"]:
            return False
        return not (self.enabled & POLYGON and self._outside_figures(place_m))

    def mode_changed(self, now_s: float) -> None:
        """Whoever changes the mode outside a fence is given 10 s to bring the vehicle back."""
        if self.breached:
            self.unwatched_until_s = now_s + _RECOVERY_S

    def check(self, now_s: float) -> int:
        """Look where the vehicle is; the mask of fences newly crossed.

        A ceiling, floor or circle is crossed anew every 20 m farther out.
        """
        p, enabled = self.params, self.enabled
        if enabled and now_s < self.unwatched_until_s:
            return 0
        east, north, up = self.position.from_home_m
        beyond = {
            ALT_MAX: up - p["FENCE_ALT_MAX"],
            ALT_MIN: p["FENCE_ALT_MIN"] - up if self.floor else -math.inf,
            CIRCLE: math.hypot(east, north) - p["FENCE_RADIUS"],
            POLYGON: -math.inf,
        }
        if enabled & POLYGON and self._outside_figures(self.position.body.position_m):
            beyond[POLYGON] = 0.0
        new = 0
        for kind, metres in beyond.items():
            if not enabled & kind or metres < 0:
                self.breached &= ~kind
                self._again_at_m.pop(kind, None)
            elif not self.breached & kind or metres >= self._again_at_m[kind]:
                self.breached |= kind
                self._again_at_m[kind] = metres + _AGAIN_M if kind != POLYGON else math.inf
                new |= kind
        self.beyond_m = max((m for kind, m in beyond.items() if new & kind), default=0.0)
        return new

    def fault(self) -> str:
        """Why the vehicle may not be armed, in the autopilot's words; empty if it may."""
        p, enabled = self.params, self.enabled
        if p["FENCE_ENABLE"] and not self._present:
            return "Fences enabled, but none selected"
        margin, low, high = p["FENCE_MARGIN"], p["FENCE_ALT_MIN"], p["FENCE_ALT_MAX"]
        wrong = (
            (self.level and not self.position.from_home_known, "Fence requires position"),
            (p["FENCE_RADIUS"] < 0, "Invalid FENCE_RADIUS value"),
            (p["FENCE_RADIUS"] < margin, "FENCE_MARGIN is less than FENCE_RADIUS"),
            (high < 0, "Invalid FENCE_ALT_MAX value"),
            (low < _LOWEST_M, "Invalid FENCE_ALT_MIN value"),
            (self.breached, "vehicle outside fence"),
            (margin < 0, "Invalid FENCE_MARGIN value"),
            (high < low, "FENCE_ALT_MAX < FENCE_ALT_MIN"),
            (high - low <= 2.0 * margin, "FENCE_MARGIN too big"),
        )
        return next((text for is_so, text in wrong if is_so), "") if enabled else ""

    @property
    def _present(self) -> bool:
        kinds = int(self.params["FENCE_TYPE"])
        figures = kinds & POLYGON and self.store.lists[FENCE]
        return bool(kinds & (ALT_MAX | ALT_MIN | CIRCLE) or figures)

    def _outside_figures(self, place_m: tuple[float, float, float]) -> bool:
        """Outside one of the figures to be inside of, or inside of one to keep out of."""
        items = self.store.lists[FENCE]
        k = 0
        while k < len(items):
            item = items[k]
            size = int(item.params[0]) if item.command in (POLYGON_IN, POLYGON_OUT) else 1
            corners = [self.position.local_m(i.x, i.y) for i in items[k : k + size]]
            k += size
            if item.command in (CIRCLE_IN, CIRCLE_OUT):
                inside = math.dist(place_m[:2], corners[0]) <= item.params[0]
            elif item.command in (POLYGON_IN, POLYGON_OUT):
                inside = _inside(place_m[:2], corners)
            else:
                continue
            if inside == (item.command in (POLYGON_OUT, CIRCLE_OUT)):
                return True
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
