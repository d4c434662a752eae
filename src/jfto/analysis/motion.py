"""How each UAV of a plan moves, and how far arrivals may be off where nothing holds them to it."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from scipy.signal import savgol_filter

from jfto_msgs_py.errors import InfeasibleError
from jfto_msgs_py.records.plan import Plan, Uav
from jfto_msgs_py.types import Array
from jfto_planner.smoothing import Trajectory
from jfto_world.motion import MotionLimits, TimeModel, time_model_named
from jfto_world.motion.lines import along

STEP_S = 0.05
# A vehicle's positions are differentiated over this window, as its own filters would smooth them.
_WINDOW = 21


@dataclass(frozen=True)
class Motion:
    """One UAV's flight at `times_s` (T,), until its last waypoint.

    `position_m` is (T, 3); `speed_mps`, `acceleration_mps2` and `jerk_mps3` (T,) are magnitudes,
    the last two None where speed jumps.
    """

    times_s: Array
    position_m: Array
    speed_mps: Array
    acceleration_mps2: Array | None
    jerk_mps3: Array | None


def motions(plan: Plan) -> tuple[Motion, ...]:
    """Motion of each UAV by the plan's time model; raises InputError for an unknown one."""
    return tuple(_one(plan, index, uav) for index, uav in enumerate(plan.uavs))


def _one(plan: Plan, index: int, uav: Uav) -> Motion:
    count = max(int(np.ceil(plan.routes[index].end_s / STEP_S)), _WINDOW) + 1
    times: Array = np.arange(count, dtype=np.float64) * STEP_S
    if plan.trajectories:
        motion = Trajectory.from_record(plan.trajectories[index]).motion(times)
        return Motion(
            times,
            motion.position_m,
            _size(motion.velocity_mps),
            _size(motion.acceleration_mps2),
            _size(motion.jerk_mps3),
        )
    line, limits = plan.line_m(index), _limits(uav)
    model = along(time_model_named(plan.time_model, plan.time_parameters), plan.routes[index].lines)
    # At rest before and after, so that the window has something to look at there.
    rest = np.arange(1, _WINDOW + 1) * STEP_S
    longer = np.concatenate([-rest[::-1], times, times[-1] + rest])
    position = model.positions(line, limits, longer)
    kept = slice(_WINDOW, -_WINDOW)
    if plan.time_model == "constant_speed":
        speed = _size(np.gradient(position, STEP_S, axis=0))
        return Motion(times, position[kept], speed[kept], None, None)
    velocity, acceleration, jerk = (
        savgol_filter(position, _WINDOW, 4, deriv=order, delta=STEP_S, axis=0)[kept]
        for order in (1, 2, 3)
    )
    return Motion(times, position[kept], _size(velocity), _size(acceleration), _size(jerk))


def _limits(uav: Uav) -> MotionLimits:
    return MotionLimits(uav.speed_mps, uav.climb_mps, uav.descent_mps)


def _size(vectors: Array) -> Array:
    return np.asarray(np.linalg.norm(vectors, axis=1))


@dataclass(frozen=True)
class Spread:
    """One UAV's arrivals in other circumstances, less the planned ones; seconds, late is positive.

    `planner_s` are the first and last of all differences, over its waypoints, under the autopilot's
    own planner without the vehicle's lag; `wind_s` those over four winds, infinite where the
    vehicle cannot make way against one.
    """

    uav: str
    end_s: float
    planner_s: tuple[float, float]
    wind_s: tuple[float, float]


def flight_spread(plan: Plan, wind_mps: float) -> tuple[Spread, ...]:
    """Spread of every UAV with waypoints; empty unless the plan is of the autopilot's missions.

    The planned times are those of the closed loop in calm air; winds blow to the four quarters.
    """
    if plan.time_model != "arducopter":
        return ()
    from jfto_world.motion.arducopter import ArduCopter

    model = ArduCopter.of_parameters(plan.time_parameters)
    quarters = ((1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0))
    winds = [replace(model, wind_mps=(e * wind_mps, n * wind_mps)) for e, n in quarters]
    found = []
    for index, (uav, route) in enumerate(zip(plan.uavs, plan.routes, strict=True)):
        if not route.waypoint_ids:
            continue
        line, limits = plan.line_m(index), _limits(uav)
        planned = np.array(route.arrival_s)
        late = partial(_late, line=line, limits=limits, planned=planned)
        planner = late(along(replace(model, closed_loop=False), route.lines))
        blown = np.concatenate([late(along(wind, route.lines)) for wind in winds])
        found.append(Spread(uav.id, float(planned[-1]), _range(planner), _range(blown)))
    return tuple(found)


def spread_text(spread: tuple[Spread, ...], wind_mps: float) -> str:
    """One sentence on the whole fleet; empty without a spread."""
    if not spread:
        return ""
    planner = max(max(map(abs, one.planner_s)) for one in spread)
    early = min(one.wind_s[0] for one in spread)
    late = max(one.wind_s[1] for one in spread)
    windy = (
        f"in {wind_mps:g} m/s of wind, from any quarter, they are {early:+.1f} to {late:+.1f} s off"
        if np.isfinite(late)
        else f"a wind of {wind_mps:g} m/s is more than its tilt limit lets a UAV fly against"
    )
    return (
        f"Without time gates: the vehicle's lag moves arrivals by up to {planner:.1f} s, which is "
        f"in the plan; {windy}. With time gates slots are absolute."
    )


def _late(model: TimeModel, line: Array, limits: MotionLimits, planned: Array) -> Array:
    try:
        return np.asarray(model.arrivals(line, limits)[1:] - planned)
    except InfeasibleError:
        return np.full(len(planned), np.inf)


def _range(differences: Array) -> tuple[float, float]:
    return float(differences.min()), float(differences.max())
