"""How each UAV of a plan moves: position, speed, acceleration and jerk over time."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.signal import savgol_filter

from jfto_msgs_py.plan import Plan, Uav
from jfto_msgs_py.types import Array
from jfto_planner.smoothing import Trajectory
from jfto_world.motion import MotionLimits, time_model_named

STEP_S = 0.05
# A vehicle's positions are differentiated over this window, as its own filters would smooth them.
_WINDOW = 21


@dataclass(frozen=True)
class Flown:
    """One UAV's flight at `times_s` (T,), until its last waypoint.

    `position_m` is (T, 3); `speed_mps`, `acceleration_mps2` and `jerk_mps3` (T,) are magnitudes,
    the last two None where speed jumps.
    """

    times_s: Array
    position_m: Array
    speed_mps: Array
    acceleration_mps2: Array | None
    jerk_mps3: Array | None


def flown(plan: Plan) -> tuple[Flown, ...]:
    """Flights of a plan's UAVs by its own time model; raises InputError for an unknown one."""
    return tuple(_one(plan, index, uav) for index, uav in enumerate(plan.uavs))


def _one(plan: Plan, index: int, uav: Uav) -> Flown:
    route = plan.routes[index]
    end_s = max(route.arrival_s, default=0.0)
    count = max(int(np.ceil(end_s / STEP_S)), _WINDOW) + 1
    times: Array = np.arange(count, dtype=np.float64) * STEP_S
    if plan.trajectories:
        motion = Trajectory.from_record(plan.trajectories[index]).motion(times)
        return Flown(
            times,
            motion.position_m,
            _size(motion.velocity_mps),
            _size(motion.acceleration_mps2),
            _size(motion.jerk_mps3),
        )
    where = {waypoint.id: waypoint.position_m for waypoint in plan.waypoints}
    line = np.array([uav.start_m, *(where[number] for number in route.waypoint_ids)])
    limits = MotionLimits(uav.speed_mps, uav.climb_mps, uav.descent_mps)
    model = time_model_named(plan.time_model, plan.time_parameters)
    # At rest before and after, so that the window has something to look at there.
    rest = np.arange(1, _WINDOW + 1) * STEP_S
    longer = np.concatenate([-rest[::-1], times, times[-1] + rest])
    position = model.positions(line, limits, longer)
    kept = slice(_WINDOW, -_WINDOW)
    if plan.time_model == "constant_speed":
        speed = _size(np.gradient(position, STEP_S, axis=0))
        return Flown(times, position[kept], speed[kept], None, None)
    velocity, acceleration, jerk = (
        savgol_filter(position, _WINDOW, 4, deriv=order, delta=STEP_S, axis=0)[kept]
        for order in (1, 2, 3)
    )
    return Flown(times, position[kept], _size(velocity), _size(acceleration), _size(jerk))


def _size(vectors: Array) -> Array:
    return np.asarray(np.linalg.norm(vectors, axis=1))
