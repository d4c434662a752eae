"""A way home as the autopilot flies it: when it is where."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from jfto_msgs_py.plan_file import rounded_record
from jfto_msgs_py.records.plan import Plan, Uav
from jfto_msgs_py.types import Array
from jfto_world.motion import MotionLimits
from jfto_world.motion.landing import landing_places, landing_s
from jfto_world.motion.way_home import home_model


@dataclass(frozen=True, eq=False)
class FlownWay:
    """A way home, its times counted from when it begins.

    `points_m` (K, 3) are reached at `reached_s` (K,); `places_m` (N, 3) are where it is at `at_s`
    (N,), from its first point to the ground.
    """

    points_m: Array
    reached_s: Array
    at_s: Array
    places_m: Array

    @property
    def duration_s(self) -> float:
        """From its first point until it stands on the pad."""
        return float(self.at_s[-1])


def fly_way(plan: Plan, uav: Uav, points_m: Array, step_s: float) -> FlownWay:
    """Fly points (K, 3) by the plan's time model of ways home, then land; places every `step_s`."""
    limits = MotionLimits(uav.speed_mps, uav.climb_mps, uav.descent_mps)
    model = home_model(plan.time_model, plan.time_parameters)
    still = len(points_m) == 1
    # As a plan file keeps them.
    reached = np.array(rounded_record([0.0] if still else model.arrivals(points_m, limits)))
    end_s = float(reached[-1])
    down_s = landing_s(float(points_m[-1, 2] - uav.start_m[2]))
    moving = np.append(np.arange(0.0, end_s, step_s), end_s)
    sinking = np.append(np.arange(step_s, down_s, step_s), down_s)
    flown = points_m if still else model.positions(points_m, limits, moving)
    landing = landing_places(points_m[-1], uav.start_m[2], sinking)
    return FlownWay(
        points_m,
        reached,
        np.concatenate([moving, end_s + sinking]),
        np.concatenate([flown, landing]),
    )
