"""From routes to the plan record."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from jfto_msgs_py.plan import Origin, Plan, Route, Slots, Uav, Waypoint
from jfto_msgs_py.radio import Radio
from jfto_world.motion import MotionLimits, time_model_named


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
) -> Plan:
    """Plan of routes given as indices into `waypoints`, one route per UAV.

    Arrivals, lengths and positions follow from the named time model; slots divide `horizon_s`, or
    the makespan where it is None. Raises InputError for an unknown time model.
    """
    model = time_model_named(time_model)
    lines, arrivals, limits = [], [], []
    for uav, route in zip(uavs, routes, strict=True):
        points = [uav.start_m, *(waypoints[index].position_m for index in route)]
        lines.append(np.array(points, dtype=np.float64))
        limits.append(MotionLimits(uav.speed_mps, uav.climb_mps, uav.descent_mps))
        arrivals.append(model.arrivals(lines[-1], limits[-1]))
    horizon = max(float(arrival[-1]) for arrival in arrivals) if horizon_s is None else horizon_s
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
            for route, line, arrival in zip(routes, lines, arrivals, strict=True)
        ),
        positions_m=np.stack(
            [
                model.positions(line, limit, slots.times_s)
                for line, limit in zip(lines, limits, strict=True)
            ]
        ),
        time_model=time_model,
    )
