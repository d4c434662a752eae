"""How far arrivals may be from the plan where no time gate or stream holds them to it."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from jfto_msgs_py.errors import InfeasibleError
from jfto_msgs_py.plan import Plan
from jfto_msgs_py.types import Array
from jfto_world.motion import MotionLimits

if TYPE_CHECKING:
    from jfto_world.motion.arducopter import ArduCopter


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
    where = {waypoint.id: waypoint.position_m for waypoint in plan.waypoints}
    found = []
    for uav, route in zip(plan.uavs, plan.routes, strict=True):
        if not route.waypoint_ids:
            continue
        line = np.array([uav.start_m, *(where[number] for number in route.waypoint_ids)])
        limits = MotionLimits(uav.speed_mps, uav.climb_mps, uav.descent_mps)
        planned = np.array(route.arrival_s)
        planner = _late(replace(model, closed_loop=False), line, limits, planned)
        blown = np.concatenate([_late(wind, line, limits, planned) for wind in winds])
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


def _late(model: ArduCopter, line: Array, limits: MotionLimits, planned: Array) -> Array:
    try:
        return np.asarray(model.arrivals(line, limits)[1:] - planned)
    except InfeasibleError:
        return np.full(len(planned), np.inf)


def _range(differences: Array) -> tuple[float, float]:
    return float(differences.min()), float(differences.max())
