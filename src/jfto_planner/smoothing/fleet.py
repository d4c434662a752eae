"""A whole fleet's routes to trajectories: smooth, above the ground, apart from one another."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field

import numpy as np

from jfto_msgs_py.errors import InfeasibleError
from jfto_msgs_py.types import Array, GroundHeight
from jfto_planner.smoothing.limits import CurveLimits
from jfto_planner.smoothing.separation import NeighbourCheck, separate
from jfto_planner.smoothing.smooth import RouteRequest, SmoothingSettings, smooth_route
from jfto_planner.smoothing.terrain import Clearance, KeepOut, smooth_above
from jfto_planner.smoothing.trajectory import Trajectory


@dataclass(frozen=True)
class CurveRules:
    """What curves must keep to besides each vehicle's limits.

    `hold_s` > 0 stops at every waypoint, `cap_mps` bounds the speed there. `keep_out` says which of
    places (K, 3) must not be flown through; straight legs do not.
    """

    clearance: Clearance
    hold_s: float = 0.0
    cap_mps: float = np.inf
    settings: SmoothingSettings = field(default_factory=SmoothingSettings)
    keep_out: KeepOut | None = None


def smooth_fleet(
    names: tuple[str, ...],
    lines_m: tuple[Array, ...],
    limits: tuple[CurveLimits, ...],
    ground_height: GroundHeight,
    rules: CurveRules,
    workers: int = 2,
) -> tuple[Trajectory, ...]:
    """Trajectories of routes above the ground.

    Parameters
    ----------
    names
        Of the vehicles, for errors.
    lines_m
        Routes (M, 3), ENU m.
    limits
        Of each vehicle.
    ground_height
        Height of the ground at (x_m, y_m), m.
    rules
        What curves must keep to besides.
    workers
        Threads; the result does not depend on them.

    Returns
    -------
    tuple of Trajectory
        One per route.

    Raises
    ------
    InfeasibleError
        Names the vehicle whose route cannot be flown within the rules.
    """

    def one(index: int) -> Trajectory:
        line = lines_m[index]
        if len(line) == 1:
            return smooth_route(RouteRequest(line, limits[index]))
        hold = np.full(len(line), rules.hold_s)
        hold[0] = 0.0
        request = RouteRequest(
            line, limits[index], hold_s=hold, cap_mps=np.full(len(line), rules.cap_mps)
        )
        try:
            return smooth_above(
                request, ground_height, rules.clearance, rules.settings, rules.keep_out
            )
        except InfeasibleError as error:
            raise InfeasibleError(f"{names[index]}: {error}", cures=error.cures) from None

    with ThreadPoolExecutor(max_workers=max(1, workers)) as pool:
        return tuple(pool.map(one, range(len(lines_m))))


def kept_apart(
    trajectories: tuple[Trajectory, ...], d_min_m: float, neighbours_kept: NeighbourCheck
) -> tuple[Trajectory, ...]:
    """The fleet with start delays and slower flight that keep it apart, where there are any.

    Where there are none it is left as it is, for the certificate to say so.

    Parameters
    ----------
    trajectories
        Trajectories of the fleet, one per UAV.
    d_min_m
        Least distance between two UAVs, m.
    neighbours_kept
        Whether positions (K, A, 3) keep the neighbour rule.

    Returns
    -------
    tuple of Trajectory
        Delayed and slowed, in the same order.
    """
    try:
        return separate(trajectories, d_min_m, neighbours_kept=neighbours_kept)
    except InfeasibleError:
        return trajectories
