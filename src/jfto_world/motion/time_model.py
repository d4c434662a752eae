"""The one interface through which everything asks when a UAV is where."""

from __future__ import annotations

from typing import Protocol

from jfto_msgs_py.types import Array
from jfto_world.motion.limits import MotionLimits


class TimeModel(Protocol):
    """Time along a route, from lift-off at the start point to the last waypoint and after.

    After its last waypoint a UAV holds there. Points are (M, 3) in ENU metres; times are seconds.
    """

    def leg_matrix(self, points_m: Array, limits: MotionLimits) -> Array:
        """Time of the direct leg between each ordered pair of points, shape (M, M).

        An estimate that ignores what comes before and after a leg: searches use it.
        """

    def overhead_s(self, limits: MotionLimits) -> float:
        """Time of a whole route beyond the sum of its `leg_matrix` entries, s."""

    def arrivals(self, route_m: Array, limits: MotionLimits) -> Array:
        """Arrival time at each point of a route, shape (M,), the first being 0."""

    def positions(self, route_m: Array, limits: MotionLimits, times_s: Array) -> Array:
        """Positions at the given times, shape (T, 3)."""
