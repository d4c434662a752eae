"""From routes to the plan record."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from jfto_msgs_py.plan_file import rounded_record
from jfto_msgs_py.records.plan import Origin, Plan, Route, Slots, Uav, Waypoint
from jfto_msgs_py.records.radio import Radio
from jfto_msgs_py.types import Array
from jfto_planner.smoothing.trajectory import Trajectory
from jfto_world.motion import MotionLimits, TimeModel, time_model_named

# Arrivals at pad and waypoints, and positions at given times.
_Flight = tuple[Array, Callable[[Array], Array]]


def build_plan(
    routes: Sequence[Sequence[int]],
    *,
    waypoints: tuple[Waypoint, ...],
    uavs: tuple[Uav, ...],
    slot_count: int,
    horizon_s: float | None,
    k_min: int,
    delta: int,
    d_min_m: float,
    length_max_m: float,
    radio: Radio,
    origin: Origin,
    scenario_hash: str,
    seed: int,
    time_model: str = "constant_speed",
    time_parameters: Mapping[str, float] | None = None,
    trajectories: Sequence[Trajectory] = (),
) -> Plan:
    """Plan of routes given as indices into `waypoints`, one route per UAV.

    Arrivals and positions follow from the named time model, or from `trajectories`, one per UAV,
    where they are given; lengths are those of straight legs. Slots divide `horizon_s`, or the
    makespan where it is None. Raises InputError for an unknown time model.
    """
    records = tuple(rounded_record(trajectory.as_record()) for trajectory in trajectories)
    parameters: dict[str, float] = rounded_record(dict(time_parameters or {}))
    flights: list[_Flight] = []
    lines = []
    for uav, route in zip(uavs, routes, strict=True):
        points = [uav.start_m, *(waypoints[index].position_m for index in route)]
        lines.append(np.array(points, dtype=np.float64))
    if records:
        flights = [_on_curve(Trajectory.from_record(record)) for record in records]
    else:
        model = time_model_named(time_model, parameters)
        flights = [_by_model(model, line, uav) for line, uav in zip(lines, uavs, strict=True)]
    horizon = max(float(arrival[-1]) for arrival, _ in flights) if horizon_s is None else horizon_s
    slots = Slots(slot_count, horizon / slot_count)
    return Plan(
        scenario_hash=scenario_hash,
        seed=seed,
        origin=origin,
        radio=radio,
        k_min=k_min,
        delta=delta,
        d_min_m=d_min_m,
        length_max_m=length_max_m,
        slots=slots,
        waypoints=waypoints,
        uavs=uavs,
        routes=tuple(
            Route(
                waypoint_ids=tuple(waypoints[index].id for index in route),
                arrival_s=tuple(float(time) for time in arrival[1:]),
                length_m=float(np.linalg.norm(np.diff(line, axis=0), axis=1).sum()),
            )
            for route, line, (arrival, _) in zip(routes, lines, flights, strict=True)
        ),
        positions_m=np.stack([position(slots.times_s) for _, position in flights]),
        time_model=time_model,
        time_parameters=parameters,
        trajectories=records,
    )


def _on_curve(trajectory: Trajectory) -> _Flight:
    return np.concatenate([[0.0], trajectory.waypoint_s[1:]]), trajectory.positions


def _by_model(model: TimeModel, line: Array, uav: Uav) -> _Flight:
    limits = MotionLimits(uav.speed_mps, uav.climb_mps, uav.descent_mps)
    return model.arrivals(line, limits), lambda times_s: model.positions(line, limits, times_s)
