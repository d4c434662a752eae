"""The planner's target point along a whole route: when it is where, in closed form."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from jfto_msgs_py.errors import InputError
from jfto_msgs_py.types import Array, Flags
from jfto_world.motion.arducopter.leg_profile import (
    COLUMNS,
    plan_legs,
    planner_limits,
    sample_target,
)
from jfto_world.motion.arducopter.wpnav import WpNav


@dataclass(frozen=True)
class TargetTrack:
    """The target's motion along one route of M points, time 0 being the start of the first leg.

    `legs` (M - 1, 14) as in `leg_profile`; `begin_s` (M - 1,) when each leg begins to move the
    target; `half_overlap_s` (M,) half of the overlap at each point, 0 at stops; `reached_s` (M,)
    when the autopilot reports each point as reached, holds included.
    """

    points_m: Array
    legs: Array
    begin_s: Array
    half_overlap_s: Array
    reached_s: Array

    @property
    def duration_s(self) -> float:
        """Time at which the last point is reached."""
        return float(self.reached_s[-1])

    def motion(self, times_s: Array) -> tuple[Array, Array, Array]:
        """Position, velocity and acceleration at the given times, each (T, 3)."""
        times = np.atleast_1d(np.asarray(times_s, dtype=np.float64))
        out = np.zeros((len(times), 3, 3))
        last = np.searchsorted(self.begin_s, times, side="right") - 1
        sample_target(self.points_m, self.legs, self.begin_s, times, last, out)
        return out[:, 0], out[:, 1], out[:, 2]

    def positions(self, times_s: Array) -> Array:
        """Position at the given times, (T, 3); the first and last points before and after."""
        return self.motion(times_s)[0]


def plan_target(
    points_m: Array, wpnav: WpNav, stop: Flags | None = None, hold_s: Array | None = None
) -> TargetTrack:
    """Target motion along a route.

    Parameters
    ----------
    points_m
        (M, 3), ENU m, the start first; M >= 1.
    wpnav
        The planner's parameters.
    stop
        (M,), where the vehicle must come to rest; the ends always are.
    hold_s
        (M,), rest at each point in s, > 0 makes it a stop; the first is ignored.

    Returns
    -------
    TargetTrack
        Legs and times.

    Raises
    ------
    InputError
        Shapes disagree.
    """
    points, stops, holds = route_arrays(points_m, stop, hold_s)
    count = len(points)
    legs = np.zeros((max(count - 1, 0), COLUMNS))
    times = np.zeros((3, count))
    plan_legs(points, planner_limits(wpnav), stops, holds, legs, times)
    return TargetTrack(points, legs, times[0, :-1], times[1], times[2])


def route_arrays(
    points_m: Array, stop: Flags | None, hold_s: Array | None
) -> tuple[Array, Flags, Array]:
    """Checked copies of the (M, 3) points, (M,) stops and (M,) holds of a route."""
    points = np.array(points_m, dtype=np.float64, order="C")
    if points.ndim != 2 or points.shape[1] != 3 or len(points) == 0:
        raise InputError(f"points_m has shape {points.shape}, must be (M, 3) with M >= 1.")
    count = len(points)
    holds = np.zeros(count) if hold_s is None else np.array(hold_s, dtype=np.float64)
    stops = np.zeros(count, dtype=np.bool_) if stop is None else np.array(stop, dtype=np.bool_)
    if holds.shape != (count,) or stops.shape != (count,):
        raise InputError(
            f"hold_s {holds.shape} and stop {stops.shape} must be ({count},), one per point."
        )
    if not (np.all(np.isfinite(points)) and np.all(np.isfinite(holds)) and np.all(holds >= 0)):
        raise InputError("points_m and hold_s must be finite and holds not negative.")
    stops |= holds > 0
    stops[0] = stops[-1] = True
    return points, stops, holds
