"""A way home as it is flown: when it is where, by the plan's time model or as a curve."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from jfto_msgs_py.plan_file import rounded_record
from jfto_msgs_py.records.plan import Plan, Uav
from jfto_msgs_py.types import Array
from jfto_planner.home.stopping_curve import stopping_curve
from jfto_planner.smoothing.limits import CurveLimits
from jfto_world.motion import ConstantSpeed, MotionLimits
from jfto_world.motion.landing import landing_places, landing_s


@dataclass(frozen=True, eq=False)
class FlownWay:
    """A way home, its times counted from when it begins.

    `points_m` (K, 3) are reached at `reached_s` (K,); `places_m` (N, 3) are where it is at `at_s`
    (N,), from its first point to the ground. `trajectory` is the curve's record, empty without.
    """

    points_m: Array
    reached_s: Array
    at_s: Array
    places_m: Array
    trajectory: Mapping[str, Any]

    @property
    def duration_s(self) -> float:
        """From its first point until it stands on the pad."""
        return float(self.at_s[-1])


def fly_way(plan: Plan, uav: Uav, points_m: Array, step_s: float) -> FlownWay:
    """Fly points (K, 3) as the plan's other legs are flown, then land; places every `step_s`."""
    limits = MotionLimits(uav.speed_mps, uav.climb_mps, uav.descent_mps)
    trajectory: Mapping[str, Any] = {}
    positions: Callable[[Array], Array]
    if len(points_m) == 1:
        reached, positions = np.zeros(1), lambda times_s: np.tile(points_m[0], (len(times_s), 1))
    elif plan.time_model == "bezier":
        curve = stopping_curve(points_m, CurveLimits.of(limits, **plan.time_parameters))
        trajectory = curve.as_record()
        reached, positions = curve.waypoint_s, curve.positions
    else:
        model = _through(plan)
        reached = model.arrivals(points_m, limits)
        positions = lambda times_s: model.positions(points_m, limits, times_s)  # noqa: E731
    # As a plan file keeps them.
    reached = np.array(rounded_record(reached))
    end_s = float(reached[-1])
    down_s = landing_s(float(points_m[-1, 2] - uav.start_m[2]))
    moving = np.append(np.arange(0.0, end_s, step_s), end_s)
    sinking = np.append(np.arange(step_s, down_s, step_s), down_s)
    landing = landing_places(points_m[-1], uav.start_m[2], sinking)
    return FlownWay(
        points_m,
        reached,
        np.concatenate([moving, end_s + sinking]),
        np.concatenate([positions(moving), landing]),
        trajectory,
    )


def _through(plan: Plan) -> Any:
    """The time model of a plan for legs without lift-off or holds."""
    if plan.time_model == "constant_speed":
        return ConstantSpeed()
    # Loaded here: its compiler takes a second, which constant speed need not pay.
    from jfto_world.motion.arducopter import ArduCopter

    return replace(ArduCopter.of_parameters(plan.time_parameters), hold_s=0.0, takeoff_m=0.0)
