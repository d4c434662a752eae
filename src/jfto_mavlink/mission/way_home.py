"""The end of a mission: the way home that the plan has, and where RTL flies in an emergency.

AUTO flies what was planned: it holds, flies the way home and lands. RTL is for orders and
failsafes; each vehicle has a height of its own for it, since they may all return at once.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from jfto_mavlink.dialect import mavlink
from jfto_mavlink.mission.limits import Ground, MissionLimits, return_height_m
from jfto_mavlink.protocol.item import FRAME_HOME, FRAME_NONE, Item, at
from jfto_msgs_py.records.plan import Plan
from jfto_msgs_py.records.way_home import WayHome
from jfto_world.motion.landing import LAND_FROM_M, LAND_MPS
from jfto_world.terrain.frame import LocalFrame

Place = tuple[float, float, float]

# RTL heights lie so much farther apart than UAVs must be.
LAYER_SPARE_M = 1.0
# RTL_ALT of the autopilot: no vehicle returns lower than this.
LEAST_RETURN_M = 15.0


def home_items(
    home: WayHome, frame: LocalFrame, last: Place, pad: Place, streamed: Sequence[Item] = ()
) -> list[Item]:
    """Items that hold at `last`, fly the way home and land on `pad`.

    Both are latitude, longitude and height: `last` above home, `pad` absolute. A vehicle that
    was streamed to until the horizon begins by waiting where it is, then by `streamed`.
    """
    hold_s = round(home.hold_s)
    begin = [at(mavlink.MAV_CMD_NAV_LOITER_TIME, FRAME_HOME, *last, hold_s)]
    if streamed:
        begin = [Item(mavlink.MAV_CMD_NAV_DELAY, FRAME_NONE, (hold_s, 0.0, 0.0, 0.0)), *streamed]
    lat, lon, alt = frame.to_geodetic(home.line_m[1:].reshape(-1, 3))
    legs = [
        at(mavlink.MAV_CMD_NAV_WAYPOINT, FRAME_HOME, *place)
        for place in zip(lat, lon, alt - pad[2], strict=True)
    ]
    return [*begin, *legs, at(mavlink.MAV_CMD_NAV_LAND, FRAME_HOME, *pad[:2], 0.0)]


def landing_parameters() -> tuple[tuple[str, float], ...]:
    """Parameters under which a landing takes as long as planned."""
    return ("LAND_SPEED", 100.0 * LAND_MPS), ("LAND_ALT_LOW", 100.0 * LAND_FROM_M)


def return_heights_m(plan: Plan, ground: Ground, limits: MissionLimits) -> tuple[float, ...]:
    """RTL height of each UAV above its pad, whole metres, all different in height above sea.

    Each clears the ground by `return_clearance_m` on the straight way home from every point of its
    route, and lies d_min and more above the next lower one. A vehicle that is higher when it turns
    home stays at the height it has.
    """
    pads = np.array([uav.start_m for uav in plan.uavs])
    needed = np.full(len(plan.uavs), LEAST_RETURN_M)
    for a in range(len(plan.uavs)):
        ways = [
            return_height_m(pads[a], point, ground, limits.return_clearance_m)
            for point in plan.line_m(a)
        ]
        needed[a] = max(needed[a], *ways)
    heights, below = np.zeros(len(plan.uavs)), -math.inf
    for a in np.argsort(pads[:, 2] + needed, kind="stable"):
        lowest = max(pads[a, 2] + needed[a], below + plan.d_min_m + LAYER_SPARE_M)
        heights[a] = min(math.ceil(lowest - pads[a, 2]), limits.height_max_m)
        below = pads[a, 2] + heights[a]
    return tuple(float(height) for height in heights)
