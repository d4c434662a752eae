"""Whether waypoints from outside can be flown over this ground at all."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.spatial import cKDTree

from jfto_msgs_py.errors import WaypointError
from jfto_planner.coverage.raw_waypoint import RawWaypoint
from jfto_world.terrain import Dem

# Closer than this two waypoints are one, entered twice.
_SAME_M = 0.01


def check_waypoints(waypoints: Sequence[RawWaypoint], dem: Dem, source: str) -> None:
    """Raise WaypointError for the first waypoint outside the terrain, in the ground or double.

    The message says how many more have the same fault.
    """
    position = np.array([item.position_m for item in waypoints], dtype=np.float64)

    outside = np.flatnonzero(~dem.contains(position[:, 0], position[:, 1]))
    if outside.size:
        first = waypoints[outside[0]]
        x, y, _ = first.position_m
        raise WaypointError(
            f"{first.place}: lies {abs(x):.0f} m {'east' if x >= 0 else 'west'} and {abs(y):.0f} m "
            f"{'north' if y >= 0 else 'south'} of the scenario's origin, outside of the terrain, "
            f"which reaches {dem.half_extent_m[0]:.0f} m and {dem.half_extent_m[1]:.0f} m"
            f"{_more(outside.size)}. Move terrain.center_deg, enlarge terrain.size_m or take it "
            f"out of {source}."
        )

    clearance = position[:, 2] - dem.top_height(position[:, 0], position[:, 1])
    buried = np.flatnonzero(clearance <= 0)
    if buried.size:
        first = waypoints[buried[0]]
        stands = "" if dem.top is None else " or what stands on it (terrain.surface)"
        raise WaypointError(
            f"{first.place}: lies {-clearance[buried[0]]:.1f} m below the ground{stands}"
            f"{_more(buried.size)}. Heights are metres above {dem.height_datum}; raise it, or give "
            "heights above ground (agl_m)."
        )

    for place in waypoints:
        if not -90 <= place.pitch_deg <= 90:
            raise WaypointError(
                f"{place.place}: pitch_deg is {place.pitch_deg}, must lie within -90 (straight "
                "down) and 90."
            )

    pairs = cKDTree(position).query_pairs(_SAME_M, output_type="ndarray")
    if len(pairs):
        one, other = sorted(map(tuple, np.sort(pairs, axis=1).tolist()))[0]
        raise WaypointError(
            f"{waypoints[other].place}: is the same place as {waypoints[one].place}"
            f"{_more(len(pairs))}. Take one of them out."
        )


def _more(count: int) -> str:
    return f" (and {count - 1} more)" if count > 1 else ""
