"""From a route to its trajectory: least total time within the limits.

Hierarchical. Inner problem: given the durations around a waypoint, its velocity and acceleration
by convex quadratic programme in closed form (least squared jerk), which fixes all control points.
Outer problem: durations, knot distances and offsets by pattern search for the least time. Where
legs are too short for cruise, a spline with one segment per leg takes over if it is faster.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from jfto_msgs_py.errors import InputError
from jfto_msgs_py.types import Array, Flags
from jfto_planner.smoothing.chain import Chain, chain_of, shorten
from jfto_planner.smoothing.kernel.segment import control_points
from jfto_planner.smoothing.limits import CurveLimits
from jfto_planner.smoothing.route_solver import RouteSolver
from jfto_planner.smoothing.trajectory import Trajectory

_NARROW = 0.4  # share of the corridor tried too where legs are short: the search is local
_MARGIN = 4e-4  # of each limit, against what happens between samples


@dataclass(frozen=True)
class SmoothingSettings:
    """How far a curve may leave the straight legs, and how hard to search.

    No point of a curve is further than `corridor_m` from its straight leg; where that leaves no way
    to fly through a waypoint, the vehicle stops there. `sweeps` improves every joint that often.
    """

    corridor_m: float = 20.0
    sweeps: int = 3

    def __post_init__(self) -> None:
        if not self.corridor_m > 0:
            raise InputError(f"corridor_m is {self.corridor_m}, must be positive.")
        if self.sweeps < 1:
            raise InputError(f"sweeps is {self.sweeps}, must be at least 1.")


@dataclass(frozen=True)
class RouteRequest:
    """One route: points (M, 3), where to stop (M,), holds in s (M,), speed caps in m/s (M,).

    None means fly through, no hold, no cap. The ends are stops always.
    """

    points_m: Array
    limits: CurveLimits
    stop: Flags | None = None
    hold_s: Array | None = None
    cap_mps: Array | None = None


def smooth_route(request: RouteRequest, settings: SmoothingSettings | None = None) -> Trajectory:
    """Least-time trajectory of one route, at rest at both ends.

    Parameters
    ----------
    request
        Points, stops, holds and speed caps of the route.
    settings
        How well the curve is made.

    Returns
    -------
    Trajectory
        Within the limits of the request.

    Raises
    ------
    InputError
        The request contradicts itself.
    InfeasibleError
        No trajectory within the limits is found.
    """
    settings = settings or SmoothingSettings()
    points, stop, hold, cap = checked(request)
    first, joint_of = _distinct(points)
    merged_stop = np.zeros(len(first), dtype=np.bool_)
    np.logical_or.at(merged_stop, joint_of, stop)
    merged_cap = np.full(len(first), np.inf)
    np.minimum.at(merged_cap, joint_of, cap)
    merged_hold = np.bincount(joint_of, weights=hold, minlength=len(first)).astype(np.float64)
    merged_stop |= merged_hold > 0
    merged_stop[[0, -1]] = True
    if len(first) == 1:
        still = np.broadcast_to(points[:1, None], (1, 6, 3)).copy()
        return Trajectory(still, np.array([max(merged_hold[0], 1e-3)]), np.cumsum(hold))
    lim = request.limits.row(_MARGIN)
    best: Chain | None = None
    for share in (1.0, _NARROW):
        solver = RouteSolver(
            points[first], merged_stop, merged_cap, lim, share * settings.corridor_m
        )
        solver.run(settings.sweeps)
        chain = shorten(chain_of(solver), solver, settings.corridor_m)
        if best is None or chain.durations.sum() < best.durations.sum():
            best = chain
        if not np.any(solver.speeds < solver.top):
            break
    assert best is not None
    control, duration, passed = _assemble(best, merged_hold)
    return Trajectory(control, duration, passed[joint_of])


def checked(request: RouteRequest) -> tuple[Array, Flags, Array, Array]:
    """Points (M, 3), stops, holds and caps (M,) of a request; raises InputError."""
    points = np.ascontiguousarray(request.points_m, dtype=np.float64)
    if points.ndim != 2 or points.shape[1] != 3 or len(points) == 0:
        raise InputError(f"points_m has shape {points.shape}, must be (M, 3) with M >= 1.")
    count = len(points)
    stop = np.zeros(count, bool) if request.stop is None else np.array(request.stop, dtype=bool)
    hold = np.zeros(count) if request.hold_s is None else np.array(request.hold_s, dtype=float)
    cap = np.full(count, np.inf) if request.cap_mps is None else np.array(request.cap_mps, float)
    for name, value in (("stop", stop), ("hold_s", hold), ("cap_mps", cap)):
        if value.shape != (count,):
            raise InputError(f"{name} has shape {value.shape}, must be ({count},).")
    if not np.all(np.isfinite(points)):
        raise InputError("points_m holds a number that is not finite.")
    if not np.all(hold >= 0) or not np.all(cap > 0):
        raise InputError("hold_s must not be negative and cap_mps must be positive.")
    return points, stop, hold, cap


def _distinct(points: Array) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Indices of points that differ from the one before, and which of these each point joins."""
    moved = np.linalg.norm(np.diff(points, axis=0), axis=1) > 1e-6
    new = np.concatenate([[True], moved])
    return np.flatnonzero(new), np.cumsum(new) - 1


def _assemble(chain: Chain, hold_s: Array) -> tuple[Array, Array, Array]:
    """Control points and durations of all segments, holds included; when each joint is passed."""
    control: list[Array] = []
    duration: list[float] = []
    passed = np.zeros(len(hold_s))
    for k, state in enumerate(chain.states):
        if k > 0:
            control.append(np.zeros((6, 3)))
            duration.append(chain.durations[k - 1])
            control_points(chain.states[k - 1], state, duration[-1], control[-1])
        joint = chain.joints[k]
        if joint >= 0:
            if hold_s[joint] > 0:
                control.append(np.broadcast_to(state[0], (6, 3)).copy())
                duration.append(hold_s[joint])
            passed[joint] = sum(duration)
    return np.array(control), np.array(duration), passed
