"""Limits that the autopilot does not check: heights, holds, distances, and room above the ground.

It stores negative heights and 18-hour holds, and knows nothing of the terrain in frame 3: these
checks are the only ones.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from jfto_mavlink.dialect import mavlink
from jfto_mavlink.errors import MissionError
from jfto_mavlink.protocol.item import FRAME_HOME, FRAME_TERRAIN, Item, distance_m
from jfto_msgs_py.types import Array
from jfto_world.mission.encoding import ITEMS_MAX

_HOLDING = (
    mavlink.MAV_CMD_NAV_WAYPOINT,
    mavlink.MAV_CMD_NAV_SPLINE_WAYPOINT,
    mavlink.MAV_CMD_NAV_LOITER_TIME,
)
# Above sea level, home or terrain, each as itself and as its _INT.
_PLACED_FRAMES = (0, 5, 3, 6, 10, 11)


@dataclass(frozen=True)
class MissionLimits:
    """What a mission may hold. Heights are above home; `items_max` includes home; 0: as
    the plan says, else 650.

    Where the ground is known, legs pass at least `clearance_min_m` above it, and the straight way
    home `return_clearance_m`.

    ArduPilot keeps hold times in 16 bits.
    """

    height_min_m: float = 0.0
    height_max_m: float = 1000.0
    distance_max_m: float = 5000.0
    hold_max_s: float = 3600.0
    items_max: int = 0
    clearance_min_m: float = 5.0
    return_clearance_m: float = 20.0

    def __post_init__(self) -> None:
        if not 0 <= self.hold_max_s < 2**16:
            raise MissionError(301, f"hold_max_s is {self.hold_max_s}, must be 0…65535.")


def check_limits(uav: str, items: Sequence[Item], limits: MissionLimits) -> None:
    """Raise MissionError that lists everything in a mission that breaks a limit."""
    problems = []
    items_max = limits.items_max or ITEMS_MAX
    if len(items) > items_max:
        problems.append(f"{len(items)} items, at most {items_max}: split the route or drop items")
    if items and (len(items) < 2 or items[1].command != mavlink.MAV_CMD_NAV_TAKEOFF):
        problems.append("item 1 must be a take-off: ArduCopter does not start AUTO without it")
    for seq, item in enumerate(items[1:], start=1):
        problems.extend(f"item {seq}: {problem}" for problem in _problems(item, items[0], limits))
    if problems:
        raise MissionError(301, f"{uav}: " + "; ".join(problems) + ".")


def _problems(item: Item, home: Item, limits: MissionLimits) -> list[str]:
    found = []
    if not all(math.isfinite(value) for value in (*item.params, item.z)):
        open_ = [f"parameter {k}" for k, v in enumerate(item.params, 1) if not math.isfinite(v)]
        names = ", ".join(open_) or "its height"
        reason = "is not a finite number, which the autopilot refuses: give it a value"
        return [f"{names} of command {item.command} {reason}"]
    if item.command in _HOLDING and not 0 <= item.params[0] <= limits.hold_max_s:
        found.append(f"hold of {item.params[0]:g} s is outside 0…{limits.hold_max_s:g} s")
    if not item.is_nav or not item.has_position:
        return found
    if item.frame not in _PLACED_FRAMES:
        found.append(
            f"frame {item.frame} of command {item.command} is none with latitude, longitude and "
            "height: use 0 (sea level) or 3 (home)"
        )
    if item.frame in (FRAME_HOME, 6, FRAME_TERRAIN, 11) and not (
        limits.height_min_m <= item.z <= limits.height_max_m
    ):
        found.append(
            f"height {item.z:.1f} m above home is outside "
            f"{limits.height_min_m:g}…{limits.height_max_m:g} m"
        )
    if abs(item.lat_deg) > 90 or abs(item.lon_deg) > 180:
        found.append(f"position {item.lat_deg}, {item.lon_deg} is not on Earth")
    elif item.x or item.y:
        away = distance_m((home.lat_deg, home.lon_deg, 0.0), (item.lat_deg, item.lon_deg, 0.0))
        if away > limits.distance_max_m:
            found.append(f"{away:.0f} m from home, at most {limits.distance_max_m:g} m")
    return found


# Ground height (ENU metres) at east and north positions, both of shape (K,).
Ground = Callable[[Array, Array], Array]

# Finer than the elevation models in use.
SAMPLE_M = 5.0


def check_clearance(uav: str, points_m: Array, ground: Ground, clearance_min_m: float) -> None:
    """Raise MissionError 301 if a straight leg between points (M, 3) comes too near the ground.

    The first point is above the pad after take-off, the others are waypoints. The message names the
    worst leg and by how much it misses.
    """
    worst, place = np.inf, 0
    for index, (start, end) in enumerate(pairwise(points_m)):
        samples = _between(start, end)
        clearance = float(np.min(samples[:, 2] - ground(samples[:, 0], samples[:, 1])))
        if clearance < worst:
            worst, place = clearance, index
    if worst < clearance_min_m:
        leg = "from take-off to waypoint 1" if place == 0 else f"from waypoint {place} onwards"
        raise MissionError(
            301,
            f"{uav}: the leg {leg} of its route passes {worst:.1f} m above the ground, at least "
            f"{clearance_min_m:g} m is wanted. Plan farther from the slope, or take off higher.",
        )


def return_height_m(pad_m: Array, last_m: Array, ground: Ground, clearance_m: float) -> float:
    """Height above the pad at which the straight way home clears all ground by `clearance_m`."""
    samples = _between(np.array([*last_m[:2], 0.0]), np.array([*pad_m[:2], 0.0]))
    return float(np.max(ground(samples[:, 0], samples[:, 1])) + clearance_m - pad_m[2])


def _between(start: Array, end: Array) -> Array:
    steps = max(int(np.linalg.norm(end - start) / SAMPLE_M), 1)
    return start + (end - start) * np.linspace(0.0, 1.0, steps + 1)[:, None]
