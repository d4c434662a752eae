"""The plan record of routes that were found for arrays, so that they can be certified and kept."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from jfto_msgs_py.errors import InputError
from jfto_msgs_py.records.plan import Origin, Plan, Uav, Waypoint
from jfto_msgs_py.records.radio import Radio
from jfto_msgs_py.units import dbm_to_w, w_to_dbm
from jfto_planner.routing.build_plan import build_plan
from jfto_planner.routing.problem import RoutingProblem
from jfto_world.motion import ConstantSpeed, TimeModel
from jfto_world.radio import make_channel

# Of a fleet whose radios' energy is not known.
ANY_ENERGY_J = 1e9


def plan_of(
    problem: RoutingProblem,
    routes: Sequence[Sequence[int]],
    *,
    radio: Radio | None = None,
    delta: int = 2,
    seed: int = 0,
    origin: Origin | None = None,
) -> Plan:
    """Plan record of routes for a problem, not yet checked: hand it to `certify`.

    UAVs are named uav1, uav2 …; their greatest powers are those that reach as far as the problem
    says.

    Parameters
    ----------
    problem
        What the routes solve.
    routes
        Indices of waypoints in order, one sequence per UAV, as in `SearchResult.routes`.
    radio
        Frequency, gains, sensitivity, bandwidth and noise; None for those of a scenario's defaults.
    delta
        Neighbours beyond K_min that the topology allows, δ.
    seed
        Of the search, for the record.
    origin
        Where the local frame sits; None for 0° N, 0° E, 0 m.

    Returns
    -------
    Plan
        With times and positions by the problem's time model.

    Raises
    ------
    InputError
        If the time model is one that a plan cannot name.
    """
    radio = radio or Radio()
    sensitivity_w = float(dbm_to_w(radio.sensitivity_dbm))
    p_max_dbm = w_to_dbm(make_channel(radio).required_power(problem.reach_m, sensitivity_w))
    energy = problem.energy_j
    uavs = tuple(
        Uav(
            id=f"uav{a + 1}",
            p_max_dbm=float(p_max_dbm[a]),
            energy_j=ANY_ENERGY_J if energy is None else float(energy[a]),
            t_max_s=float(problem.t_max_s[a]),
            speed_mps=limits.speed_mps,
            climb_mps=limits.climb_mps,
            descent_mps=limits.descent_mps,
            start_m=_vector(problem.starts_m[a]),
        )
        for a, limits in enumerate(problem.limits)
    )
    name, parameters = _named(problem.time_model)
    return build_plan(
        routes,
        waypoints=tuple(Waypoint(k, _vector(p)) for k, p in enumerate(problem.waypoints_m)),
        uavs=uavs,
        slot_count=problem.slot_count,
        horizon_s=problem.horizon_s,
        k_min=problem.k_min,
        delta=delta,
        d_min_m=problem.d_min_m,
        length_max_m=problem.length_max_m,
        radio=radio,
        origin=origin or Origin(0.0, 0.0, 0.0),
        scenario_hash="",
        seed=seed,
        time_model=name,
        time_parameters=parameters,
    )


def _named(model: TimeModel) -> tuple[str, Mapping[str, float]]:
    """Name and parameters of a time model in a plan."""
    if isinstance(model, ConstantSpeed):
        return "constant_speed", {}
    parameters = getattr(model, "parameters", None)
    if parameters is None:
        raise InputError(
            f"time_model is {type(model).__name__}, which a plan cannot name. Use ConstantSpeed or "
            "ArduCopter."
        )
    return "arducopter", parameters()


def _vector(point: np.ndarray) -> tuple[float, float, float]:
    return float(point[0]), float(point[1]), float(point[2])
