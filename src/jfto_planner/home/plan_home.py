"""Ways home for a plan: once all are done, each UAV to its pad, apart from the others."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from jfto_msgs_py.plan_file import rounded_record
from jfto_msgs_py.records.plan import Plan
from jfto_msgs_py.records.way_home import WayHome
from jfto_msgs_py.types import Array, GroundHeight, Ints
from jfto_planner.home.departures import DepartureSearch
from jfto_planner.home.flown_way import FlownWay, fly_way
from jfto_planner.home.ways import lines_home

if TYPE_CHECKING:
    # Loads shapely, which only plans with a fence need.
    from jfto_world.site.free_space import FreeSpace

# UAVs that are so early or late against one another still keep apart.
APART_S = 2.0
# Heights to choose from lie so much farther apart than UAVs must be; small fleets have more.
LAYER_SPARE_M = 1.0
LAYERS, MANY_UAVS, LAYERS_OF_MANY = 3, 12, 2
STEP_S = 0.5


@dataclass(frozen=True)
class HomeRules:
    """`height(x_m, y_m)` of the ground in the plan's frame, and the least height above it.

    `free` is where may be flown, None for everywhere.
    """

    height: GroundHeight
    clearance_m: float
    free: FreeSpace | None = None


def with_ways_home(plan: Plan, rules: HomeRules) -> Plan:
    """The plan with the ways home that bring its last UAV down soonest, of those tried.

    Nobody leaves before the horizon. Where no departures keep the fleet apart they go one by one,
    for the certificate to say what that breaks.

    Parameters
    ----------
    plan
        Routes and times to the last waypoints.
    rules
        What ways home must keep to.

    Returns
    -------
    Plan
        With a way home for each UAV.
    """
    starts = [_holds_at(plan, a) for a in range(len(plan.uavs))]
    arrived = np.array([_arrived_s(plan, a) for a in range(len(plan.uavs))])
    hold = np.maximum(np.ceil(plan.slots.horizon_s - arrived), 1.0)
    layers = LAYERS if len(plan.uavs) <= MANY_UAVS else LAYERS_OF_MANY
    ways = [
        tuple(
            fly_way(plan, uav, line, STEP_S)
            for line in lines_home(
                start,
                np.array(uav.start_m),
                rules.height,
                rules.clearance_m,
                plan.d_min_m + LAYER_SPARE_M,
                layers,
                _round(rules.free, start, np.array(uav.start_m)),
            )
        )
        for uav, start in zip(plan.uavs, starts, strict=True)
    ]
    found = DepartureSearch(ways, arrived + hold, plan.d_min_m, APART_S).best()
    chosen = _one_by_one(ways, arrived + hold) if found is None else (found.way, found.wait_s)
    homes = tuple(
        _record(way[chosen[0][a]], float(arrived[a]), float(hold[a] + chosen[1][a]))
        for a, way in enumerate(ways)
    )
    return replace(plan, homes=homes)


def _round(free: FreeSpace | None, start_m: Array, pad_m: Array) -> Array | None:
    """Where the way home passes in plan view (P, 2), round all zones that it is not over."""
    if free is None:
        return None
    ways = free.ways(np.stack([start_m, pad_m]), np.array([[0, 1]]), over=True)
    return ways.vias


def _holds_at(plan: Plan, a: int) -> Array:
    """Where UAV `a` holds after its last waypoint, (3,)."""
    route = plan.routes[a]
    return plan.line_m(a)[-1] if route.waypoint_ids else plan.positions_m[a, -1]


def _arrived_s(plan: Plan, a: int) -> float:
    """When UAV `a` has nothing left to do but to hold; its lift-off where it has no waypoints.

    Curves are streamed until the horizon: only from there on the autopilot counts for itself.
    """
    route = plan.routes[a]
    if plan.trajectories:
        return plan.slots.horizon_s
    if route.arrival_s:
        return route.arrival_s[-1]
    if plan.time_model != "arducopter":
        return 0.0
    # Loaded here: its compiler takes a second, which constant speed need not pay.
    from jfto_world.motion.arducopter import ArduCopter
    from jfto_world.motion.arducopter.takeoff import takeoff_s

    model = ArduCopter.of_parameters(plan.time_parameters)
    climb_s = takeoff_s(model.takeoff_m, plan.uavs[a].climb_mps, model.wpnav.accel_z_mps2)
    return float(rounded_record(climb_s))


def _one_by_one(ways: Sequence[Sequence[FlownWay]], ready_s: Array) -> tuple[Ints, Ints]:
    """Everybody on its first way, once all before it are down."""
    wait, down_s = np.zeros(len(ways), dtype=np.int64), 0.0
    for a in np.argsort(ready_s, kind="stable"):
        wait[a] = max(0, math.ceil(down_s - ready_s[a]))
        down_s = float(ready_s[a] + wait[a] + ways[a][0].duration_s)
    return np.zeros(len(ways), dtype=np.int64), wait


def _record(way: FlownWay, arrived_s: float, hold_s: float) -> WayHome:
    leave_s = arrived_s + hold_s
    points = tuple((float(x), float(y), float(z)) for x, y, z in way.points_m)
    return WayHome(
        hold_s=hold_s,
        points_m=points,
        reached_s=tuple(rounded_record(leave_s + float(time)) for time in way.reached_s),
        landed_s=rounded_record(leave_s + way.duration_s),
    )
