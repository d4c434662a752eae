"""The way home that a vehicle flies by itself: how high, how far above the ground, how long.

As ArduCopter's RTL: climb, straight home, wait, down, and slowly for the last metres.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from jfto_mavlink.mission.limits import Ground, MissionLimits
from jfto_mavlink.preflight.case import Case
from jfto_mavlink.preflight.fence import TOP
from jfto_mavlink.preflight.page import AMBER, GREEN, RED, Finding
from jfto_mavlink.preflight.shapes import sampled
from jfto_msgs_py.types import Array

# Near home RTL climbs by this at least, whatever its cone.
_CLIMB_LEAST_M = 2.5
_SAMPLE_M = 5.0
# So near it is over its pad, and comes down anyway.
_PAD_M = 15.0
_LIMITS = MissionLimits()


def home(case: Case) -> Iterator[Finding]:
    """Whether RTL from any place of the mission clears the ground, and below the fence's top."""
    if not case.aboard.parameters:
        yield Finding("home", AMBER, "its RTL height is not known")
        return
    rtl_m = case.value("RTL_ALT", 1500.0) / 100
    text = f"RTL_ALT {rtl_m:g} m"
    text += " (stays as high as it is)" if not rtl_m else ""
    top_m = _fence_top_m(case)
    if rtl_m > top_m:
        text += f", held down to {top_m:g} m by {_top_words(case)}"
    if case.value("RTL_ALT_TYPE"):
        cure = "Set RTL_ALT_TYPE 0: no terrain data are served."
        yield Finding("home", RED, f"{text} above terrain that it does not know", cure)
        return
    ground = case.settings.ground
    if ground is None:
        yield Finding("home", AMBER, f"{text}; the terrain is not known", "Look at the way home.")
        return
    room_m = _least_room_m(case, ground)
    needed = rtl_m + _LIMITS.return_clearance_m - room_m
    cure = f"Set RTL_ALT to {100 * np.ceil(needed):.0f} cm or more"
    if np.isfinite(top_m):
        over = f", and raise FENCE_ALT_MAX above {np.ceil(needed + _margin_m(case)):.0f} m"
        cure += over if needed > top_m else f", below {_top_words(case)}"
    clear = (
        f"clears the ground by {room_m:.0f} m on every straight way home"
        if room_m < np.inf
        else "stays above its pad"
    )
    text += f": {clear}"
    if room_m >= _LIMITS.return_clearance_m:
        yield Finding("home", GREEN, text)
        return
    level = RED if room_m < _LIMITS.clearance_min_m else AMBER
    yield Finding("home", level, f"{text}; wanted are {_LIMITS.return_clearance_m:g} m", cure + ".")


def return_heights_m(case: Case, points_m: Array) -> Array:
    """Height above home (M,) at which RTL flies home from places (M, 3) of the mission."""
    height = np.maximum(
        points_m[:, 2] + case.value("RTL_CLIMB_MIN") / 100, case.value("RTL_ALT", 1500.0) / 100
    )
    slope = case.value("RTL_CONE_SLOPE", 3.0)
    if slope > 0:
        away = np.hypot(points_m[:, 0], points_m[:, 1])
        cone = np.maximum(away * slope, points_m[:, 2] + _CLIMB_LEAST_M)
        height = np.minimum(height, cone)
    height = np.minimum(height, _fence_top_m(case))
    return np.maximum(height, points_m[:, 2])


def _fence_top_m(case: Case) -> float:
    """The height above home that RTL keeps below for the fence, infinite where it has no top."""
    if case.value("FENCE_ENABLE") and int(case.value("FENCE_TYPE")) & TOP:
        return case.value("FENCE_ALT_MAX") - _margin_m(case)
    return np.inf


def _margin_m(case: Case) -> float:
    return case.value("FENCE_MARGIN", 2.0)


def _top_words(case: Case) -> str:
    return f"FENCE_ALT_MAX {case.value('FENCE_ALT_MAX'):g} m less its margin"


def _least_room_m(case: Case, ground: Ground) -> float:
    """Least height above ground on the way home from any corner aloft, away from the pad."""
    corners, worst = case.path_m[1:], np.inf
    for corner, up in zip(corners, return_heights_m(case, corners), strict=True):
        line = sampled(np.array([[*corner[:2], up], [0.0, 0.0, up]]), _SAMPLE_M)
        line = line[np.hypot(line[:, 0], line[:, 1]) > _PAD_M] + np.array(case.mission.pad_m)
        room = line[:, 2] - ground(line[:, 0], line[:, 1])
        worst = min(worst, float(np.min(room, initial=np.inf)))
    return worst


def way_home_s(case: Case) -> float:
    """How long RTL takes from the end of the mission until the vehicle is down, s."""
    last = case.path_m[len(case.path_m) - 1 :]
    up = float(return_heights_m(case, last)[0])
    climb_mps = case.value("WPNAV_SPEED_UP", 250.0) / 100
    down_mps = case.value("WPNAV_SPEED_DN", 150.0) / 100
    level_mps = (case.value("RTL_SPEED") or case.value("WPNAV_SPEED", 1000.0)) / 100
    fast_mps = case.value("LAND_SPEED_HIGH") / 100 or down_mps
    slow_mps = case.value("LAND_SPEED", 50.0) / 100
    slow_m = min(case.value("LAND_ALT_LOW", 1000.0) / 100, up)
    climb_s = (up - float(last[0, 2])) / max(climb_mps, 0.1)
    level_s = float(np.hypot(*last[0, :2])) / max(level_mps, 0.1)
    wait_s = case.value("RTL_LOIT_TIME", 5000.0) / 1000
    down_s = (up - slow_m) / max(fast_mps, 0.1) + slow_m / max(slow_mps, 0.1)
    return climb_s + level_s + wait_s + down_s
