"""Times and positions of guided flight along the smoothed curve, behind the common interface."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import lru_cache

import numpy as np

from jfto_msgs_py.types import Array
from jfto_planner.smoothing.limits import CurveLimits, rest_to_rest_s
from jfto_planner.smoothing.smooth import RouteRequest, SmoothingSettings, smooth_route
from jfto_planner.smoothing.trajectory import Trajectory
from jfto_world.motion.time_model import MotionLimits

# share of the time lost by stops that flying through still loses, mean over random turns
_SHORT_SHARE, _LONG_SHARE = 0.85, 0.35


@dataclass(frozen=True)
class SmoothFlight:
    """`TimeModel` of guided streaming: the vehicle is on its trajectory at all times.

    The three speeds come from each vehicle's limits; `others` holds the rest of `CurveLimits`.
    `cap_mps` bounds the speed at every waypoint, `hold_s` > 0 stops there. `climb_m` counts in the
    estimate only: the vertical climb that clearance above ground will put at the start.
    """

    others: tuple[tuple[str, float], ...] = ()
    cap_mps: float = np.inf
    hold_s: float = 0.0
    climb_m: float = 0.0
    settings: SmoothingSettings = field(default_factory=SmoothingSettings)

    name = "bezier"

    def leg_matrix(self, points_m: Array, limits: MotionLimits) -> Array:
        """Estimated time of the leg between each ordered pair of points, shape (M, M)."""
        points = np.asarray(points_m, dtype=np.float64)
        return self._leg_time(points[None, :, :] - points[:, None, :], limits)

    def chain_times(self, points_m: Array, limits: MotionLimits) -> Array:
        """Estimated time of each leg from one point to the next, shape (M - 1,)."""
        return self._leg_time(np.diff(np.asarray(points_m, dtype=np.float64), axis=0), limits)

    def _leg_time(self, step: Array, limits: MotionLimits) -> Array:
        size = np.linalg.norm(step, axis=-1)
        curve = self.curve_limits(limits)
        level = np.hypot(step[..., 0], step[..., 1]) / curve.speed_mps
        rise = np.where(
            step[..., 2] > 0, step[..., 2] / curve.climb_mps, -step[..., 2] / curve.descent_mps
        )
        straight = np.maximum(level, rise)
        speed = np.divide(size, straight, out=np.ones_like(size), where=straight > 0)
        stopped = _stopped_s(size, speed, curve)
        if self.hold_s > 0:
            time = stopped + self.hold_s
        else:
            room = np.minimum(1.0, size / (2.0 * speed * _ramp_s(speed, curve)))
            share = _SHORT_SHARE + (_LONG_SHARE - _SHORT_SHARE) * room
            time = straight + share * (stopped - straight)
        return np.where(size > 0, time, 0.0)

    def overhead_s(self, limits: MotionLimits) -> float:
        """Time of a route beyond the sum of its `leg_matrix` entries: the climb from the pad, s."""
        if self.climb_m == 0:
            return 0.0
        curve = self.curve_limits(limits)
        return rest_to_rest_s(self.climb_m, curve.climb_mps, curve.accel_z_mps2, curve.jerk_mps3)

    def arrivals(self, route_m: Array, limits: MotionLimits) -> Array:
        """Time at which each point is passed (hold included), shape (M,), the first being 0."""
        passed = self.trajectory(route_m, limits).waypoint_s.copy()
        passed[0] = 0.0
        return passed

    def positions(self, route_m: Array, limits: MotionLimits, times_s: Array) -> Array:
        """Positions at the given times, shape (T, 3); stays at the last point."""
        return self.trajectory(route_m, limits).positions(times_s)

    def trajectory(self, route_m: Array, limits: MotionLimits) -> Trajectory:
        """The trajectory behind `arrivals` and `positions`."""
        route = np.ascontiguousarray(route_m, dtype=np.float64)
        return _cached(self, limits, route.tobytes(), len(route))

    def curve_limits(self, limits: MotionLimits) -> CurveLimits:
        """All limits of a vehicle's curve."""
        return CurveLimits.of(limits, **dict(self.others))


def _ramp_s(speed: Array, curve: CurveLimits) -> Array:
    """Duration of a quintic speed-up from rest."""
    return np.maximum(1.5 * speed / curve.accel_mps2, np.sqrt(6.0 * speed / curve.jerk_mps3))


def _stopped_s(size: Array, speed: Array, curve: CurveLimits) -> Array:
    """Time of legs from rest to rest: two ramps, and cruise where there is room for it."""
    by_accel = np.sqrt(size * curve.accel_mps2 / 1.5)
    by_jerk = np.cbrt(size**2 * curve.jerk_mps3 / 6.0)
    peak = np.minimum(speed, np.minimum(by_accel, by_jerk))
    return size / np.maximum(peak, 1e-9) + _ramp_s(peak, curve)


@lru_cache(maxsize=64)
def _cached(model: SmoothFlight, limits: MotionLimits, route: bytes, count: int) -> Trajectory:
    points = np.frombuffer(route, dtype=np.float64).reshape(count, 3)
    hold = np.full(count, model.hold_s)
    hold[0] = 0.0
    request = RouteRequest(
        points, model.curve_limits(limits), hold_s=hold, cap_mps=np.full(count, model.cap_mps)
    )
    return smooth_route(request, model.settings)
