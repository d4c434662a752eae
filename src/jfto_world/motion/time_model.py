"""The one interface through which everything asks when a UAV is where; its simplest answer."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from jfto_msgs_py.errors import InputError
from jfto_msgs_py.types import Array


@dataclass(frozen=True)
class MotionLimits:
    """Greatest horizontal, climb and descent speeds in m/s."""

    speed_mps: float
    climb_mps: float
    descent_mps: float

    def __post_init__(self) -> None:
        for name in ("speed_mps", "climb_mps", "descent_mps"):
            if not getattr(self, name) > 0:
                raise InputError(f"{name} is {getattr(self, name)}, must be positive.")


class TimeModel(Protocol):
    """Time along a route, from lift-off at the start point to the last waypoint and after.

    After its last waypoint a UAV holds there. Points are (M, 3) in ENU metres; times are seconds.
    """

    def leg_matrix(self, points_m: Array, limits: MotionLimits) -> Array:
        """Time of the direct leg between each ordered pair of points, shape (M, M).

        An estimate that ignores what comes before and after a leg: searches use it.
        """

    def chain_times(self, points_m: Array, limits: MotionLimits) -> Array:
        """Time of each leg from one point to the next, shape (M - 1,), as `leg_matrix` has it."""

    def overhead_s(self, limits: MotionLimits) -> float:
        """Time of a whole route beyond the sum of its `leg_matrix` entries, s."""

    def arrivals(self, route_m: Array, limits: MotionLimits) -> Array:
        """Arrival time at each point of a route, shape (M,), the first being 0."""

    def positions(self, route_m: Array, limits: MotionLimits, times_s: Array) -> Array:
        """Positions at the given times, shape (T, 3)."""


class ConstantSpeed:
    """Leg time = max(L_xy / v_xy, |Δz| / v_z), position linear in time along the leg."""

    def leg_matrix(self, points_m: Array, limits: MotionLimits) -> Array:
        """Time of the direct leg between each ordered pair of points, shape (M, M)."""
        return _leg_time(points_m[None, :, :] - points_m[:, None, :], limits)

    def chain_times(self, points_m: Array, limits: MotionLimits) -> Array:
        """Time of each leg from one point to the next, shape (M - 1,)."""
        return _leg_time(np.diff(points_m, axis=0), limits)

    def overhead_s(self, limits: MotionLimits) -> float:  # noqa: ARG002  one for all models
        """Return 0: legs are all there is."""
        return 0.0

    def arrivals(self, route_m: Array, limits: MotionLimits) -> Array:
        """Arrival time at each point of a route, shape (M,), the first being 0."""
        return np.concatenate([[0.0], np.cumsum(_leg_time(np.diff(route_m, axis=0), limits))])

    def positions(self, route_m: Array, limits: MotionLimits, times_s: Array) -> Array:
        """Positions at the given times, shape (T, 3); holds at the last point."""
        arrivals = self.arrivals(route_m, limits)
        return np.stack([np.interp(times_s, arrivals, route_m[:, k]) for k in range(3)], axis=-1)


def _leg_time(step_m: Array, limits: MotionLimits) -> Array:
    horizontal = np.hypot(step_m[..., 0], step_m[..., 1]) / limits.speed_mps
    rise = step_m[..., 2]
    vertical = np.where(rise > 0, rise / limits.climb_mps, -rise / limits.descent_mps)
    return np.maximum(horizontal, vertical)
