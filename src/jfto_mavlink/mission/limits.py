"""Limits that the autopilot does not check: it stores negative heights and 18-hour holds."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from jfto_mavlink.dialect import mavlink
from jfto_mavlink.errors import MissionError
from jfto_mavlink.mission.item import FRAME_HOME, FRAME_TERRAIN, Item, distance_m

_HOLDING = (
    mavlink.MAV_CMD_NAV_WAYPOINT,
    mavlink.MAV_CMD_NAV_SPLINE_WAYPOINT,
    mavlink.MAV_CMD_NAV_LOITER_TIME,
)


@dataclass(frozen=True)
class MissionLimits:
    """What a mission may hold. Heights are above home; `items_max` includes home.

    Where the ground is known, legs pass at least `clearance_min_m` above it, and the straight way
    home `return_clearance_m`.

    ArduPilot keeps hold times in 16 bits, and at least 650 items on the boards in use.
    """

    height_min_m: float = 0.0
    height_max_m: float = 1000.0
    distance_max_m: float = 5000.0
    hold_max_s: float = 3600.0
    items_max: int = 650
    clearance_min_m: float = 5.0
    return_clearance_m: float = 20.0

    def __post_init__(self) -> None:
        if not 0 <= self.hold_max_s < 2**16:
            raise MissionError(301, f"hold_max_s is {self.hold_max_s}, must be 0…65535.")


def check_limits(uav: str, items: Sequence[Item], limits: MissionLimits) -> None:
    """Raise MissionError that lists everything in a mission that breaks a limit."""
    problems = []
    if len(items) > limits.items_max:
        problems.append(
            f"{len(items)} items, at most {limits.items_max}: split the route or drop items"
        )
    if items and (len(items) < 2 or items[1].command != mavlink.MAV_CMD_NAV_TAKEOFF):
        problems.append("item 1 must be a take-off: ArduCopter does not start AUTO without it")
    for seq, item in enumerate(items[1:], start=1):
        problems.extend(f"item {seq}: {problem}" for problem in _problems(item, items[0], limits))
    if problems:
        raise MissionError(301, f"{uav}: " + "; ".join(problems) + ".")


def _problems(item: Item, home: Item, limits: MissionLimits) -> list[str]:
    found = []
    if not all(math.isfinite(value) for value in (*item.params, item.z)):
        return ["holds a number that is not finite"]
    if item.command in _HOLDING and not 0 <= item.params[0] <= limits.hold_max_s:
        found.append(f"hold of {item.params[0]:g} s is outside 0…{limits.hold_max_s:g} s")
    if not item.is_nav or not item.has_position:
        return found
    if item.frame in (FRAME_HOME, FRAME_TERRAIN) and not (
        limits.height_min_m <= item.z <= limits.height_max_m
    ):
        found.append(
            f"height {item.z:.1f} m above home is outside "
            f"{limits.height_min_m:g}…{limits.height_max_m:g} m"
        )
    if abs(item.lat_deg) > 90 or abs(item.lon_deg) > 180:
        found.append(f"position {item.lat_deg}, {item.lon_deg} is not on Earth")
    elif item.x or item.y:
        away = distance_m(home, item)
        if away > limits.distance_max_m:
            found.append(f"{away:.0f} m from home, at most {limits.distance_max_m:g} m")
    return found
