"""The fence of a plan as an ArduPilot fence."""

from __future__ import annotations

import numpy as np

from jfto_mavlink.mission.fence import Circle, Fence, Polygon, Position
from jfto_msgs_py.records.plan import Plan
from jfto_msgs_py.records.site import Ring
from jfto_world.terrain.frame import LocalFrame

# Polygons and circles only: ceiling, floor and circle about home are the operator's.
FIGURES_ONLY = 4.0


def plan_fence(plan: Plan) -> Fence:
    """What vehicles are to carry of a plan's fence, nothing where it has none.

    Zones with a bottom or a top are left out: figures of ArduPilot 4.5 reach from the ground to the
    sky, and a route over one of them would be a breach.
    """
    if plan.fence is None:
        return Fence()
    frame = LocalFrame(plan.origin)

    def corners(ring: Ring) -> tuple[Position, ...]:
        flat = np.array(ring)
        lat, lon, _ = frame.to_geodetic(np.column_stack([flat, np.zeros(len(flat))]))
        return tuple((float(a), float(o)) for a, o in zip(lat, lon, strict=True))

    zones = [zone for zone in plan.fence.keep_out if zone.bottom_m is None and zone.top_m is None]
    polygons = [Polygon(corners(part.outer)) for part in plan.fence.keep_in]
    holes = [corners(hole) for part in plan.fence.keep_in for hole in part.holes]
    holes += [corners(zone.outer) for zone in zones if not zone.radius_m]
    circles = [
        Circle(corners((zone.centre_m,))[0], zone.radius_m, inclusion=False)
        for zone in zones
        if zone.radius_m
    ]
    return Fence((*polygons, *(Polygon(hole, inclusion=False) for hole in holes)), tuple(circles))


def left_out(plan: Plan) -> tuple[str, ...]:
    """Names of the zones that no vehicle can carry, as they have a bottom or a top."""
    zones = () if plan.fence is None else plan.fence.keep_out
    return tuple(z.name for z in zones if z.bottom_m is not None or z.top_m is not None)
