"""Time models reduced to what a search can afford, and corrected by what they got wrong."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from jfto_msgs_py.types import Array
from jfto_world.motion import MotionLimits, TimeModel

# Fewer flights, or more alike in speed, do not tell how the factor depends on it.
LEAST_UAVS, LEAST_SPREAD_MPS = 4, 0.5


@dataclass(frozen=True)
class Calibrated:
    """A time model whose leg estimates are multiplied by a factor; exact times are its own.

    The factor is `factor` + `per_mps` · speed: fast vehicles gain more at corners. Beyond `low_mps`
    and `high_mps`, where nothing was flown, it is that of the nearest of both.
    """

    model: TimeModel
    factor: float = 1.0
    per_mps: float = 0.0
    low_mps: float = 0.0
    high_mps: float = np.inf

    def leg_matrix(self, points_m: Array, limits: MotionLimits) -> Array:
        """Time of the direct leg between each ordered pair of points, shape (M, M)."""
        return self._factor(limits) * self.model.leg_matrix(points_m, limits)

    def chain_times(self, points_m: Array, limits: MotionLimits) -> Array:
        """Estimated time of each leg from one point to the next, shape (M - 1,)."""
        return self._factor(limits) * self.model.chain_times(points_m, limits)

    def overhead_s(self, limits: MotionLimits) -> float:
        """Time of a whole route beyond the sum of its legs, s."""
        return self._factor(limits) * self.model.overhead_s(limits)

    def arrivals(self, route_m: Array, limits: MotionLimits) -> Array:
        """Arrival time at each point of a route, shape (M,), the first being 0."""
        return self.model.arrivals(route_m, limits)

    def positions(self, route_m: Array, limits: MotionLimits, times_s: Array) -> Array:
        """Positions at the given times, shape (T, 3)."""
        return self.model.positions(route_m, limits, times_s)

    def _factor(self, limits: MotionLimits) -> float:
        speed_mps = min(max(limits.speed_mps, self.low_mps), self.high_mps)
        return self.factor + self.per_mps * speed_mps


def calibrated(model: TimeModel, speed_mps: Array, flown_s: Array, expected_s: Array) -> Calibrated:
    """`model` corrected by flights of UAVs, least squares.

    Without waypoints, expected at 0 s, a UAV says nothing. Few UAVs, or alike in speed, give one
    factor for all.

    Parameters
    ----------
    model
        The estimate to correct.
    speed_mps
        Cruise speeds (A,), m/s.
    flown_s
        Durations (A,) as flown, s.
    expected_s
        Durations (A,) by `model`, s.

    Returns
    -------
    Calibrated
        Right on average for these flights.
    """
    used = expected_s > 0
    if not used.any():
        return Calibrated(model)
    mean = Calibrated(model, float(flown_s[used].sum() / expected_s[used].sum()))
    speeds, ratios = speed_mps[used], flown_s[used] / expected_s[used]
    if np.ptp(speeds) < LEAST_SPREAD_MPS or used.sum() < LEAST_UAVS:
        return mean
    slope, level = np.polyfit(speeds, ratios, 1)
    low, high = float(speeds.min()), float(speeds.max())
    return Calibrated(model, float(level), float(slope), low, high)


@dataclass(frozen=True)
class Estimated:
    """`TimeModel` that adds up the leg estimates of another one.

    Straight between points, at constant speed along each leg: for searches where the exact model
    takes too long to be asked often.
    """

    model: TimeModel

    def leg_matrix(self, points_m: Array, limits: MotionLimits) -> Array:
        """Time of the direct leg between each ordered pair of points, shape (M, M)."""
        return self.model.leg_matrix(points_m, limits)

    def chain_times(self, points_m: Array, limits: MotionLimits) -> Array:
        """Estimated time of each leg from one point to the next, shape (M - 1,)."""
        return self.model.chain_times(points_m, limits)

    def overhead_s(self, limits: MotionLimits) -> float:
        """Time of a whole route beyond the sum of its legs, s."""
        return self.model.overhead_s(limits)

    def arrivals(self, route_m: Array, limits: MotionLimits) -> Array:
        """Arrival time at each point of a route, shape (M,), the first being 0."""
        if len(route_m) < 2:
            return np.zeros(len(route_m))
        legs = self.chain_times(route_m, limits)
        return np.concatenate([[0.0], self.overhead_s(limits) + np.cumsum(legs)])

    def positions(self, route_m: Array, limits: MotionLimits, times_s: Array) -> Array:
        """Positions at the given times, shape (T, 3); holds at the last point."""
        arrivals = self.arrivals(route_m, limits)
        return np.stack([np.interp(times_s, arrivals, route_m[:, k]) for k in range(3)], axis=-1)
