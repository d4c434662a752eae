"""A small routing problem, and the plan that its routes amount to."""

from __future__ import annotations

import numpy as np
import pytest

from jfto_msgs_py.records.plan import Origin, Plan, Uav, Waypoint
from jfto_msgs_py.records.radio import Radio
from jfto_msgs_py.units import dbm_to_w
from jfto_planner.routing import PlanTerms, RoutingProblem, build_plan
from jfto_world.motion import ConstantSpeed, MotionLimits
from jfto_world.radio import make_channel

RADIO = Radio(gain_tx_dbi=0.0, gain_rx_dbi=0.0)


def small_problem(seed: int = 0, **changes: object) -> RoutingProblem:
    """Four unlike UAVs, 24 waypoints in 500 m × 500 m."""
    rng = np.random.default_rng(seed)
    power_w = dbm_to_w(np.array([20.0, 20.5, 21.0, 20.0]))
    fields: dict[str, object] = {
        "waypoints_m": np.column_stack([rng.uniform(0, 500, (24, 2)), rng.uniform(50, 80, 24)]),
        "starts_m": np.array([[240, 240, 0], [260, 240, 0], [240, 260, 0], [260, 260, 0]]),
        "limits": tuple(MotionLimits(v, 4.0, 3.0) for v in (10.0, 11.0, 12.0, 10.0)),
        "time_model": ConstantSpeed(),
        "t_max_s": np.full(4, 120.0),
        "reach_m": make_channel(RADIO).reach(power_w, float(dbm_to_w(-70.0))),
        "k_min": 2,
        "d_min_m": 5.0,
        "length_max_m": 10_000.0,
        "slot_count": 40,
    }
    return RoutingProblem(**{**fields, **changes})  # type: ignore[arg-type]


def plan_of(problem: RoutingProblem, routes: tuple[tuple[int, ...], ...]) -> Plan:
    """Plan record of a problem's routes; waypoint ids are indices + 100."""
    k = make_channel(RADIO)
    power_w = k.required_power(problem.reach_m, float(dbm_to_w(-70.0)))
    return build_plan(
        routes,
        PlanTerms(
            waypoints=tuple(
                Waypoint(100 + i, tuple(map(float, point)))  # type: ignore[arg-type]
                for i, point in enumerate(problem.waypoints_m)
            ),
            uavs=tuple(
                Uav(
                    id=f"uav{a + 1}",
                    p_max_dbm=float(10 * np.log10(power_w[a]) + 30),
                    energy_j=100.0 if problem.energy_j is None else float(problem.energy_j[a]),
                    t_max_s=float(problem.t_max_s[a]),
                    speed_mps=limits.speed_mps,
                    climb_mps=limits.climb_mps,
                    descent_mps=limits.descent_mps,
                    start_m=tuple(map(float, problem.starts_m[a])),  # type: ignore[arg-type]
                )
                for a, limits in enumerate(problem.limits)
            ),
            slot_count=problem.slot_count,
            horizon_s=problem.horizon_s,
            k_min=problem.k_min,
            delta=2,
            d_min_m=problem.d_min_m,
            length_max_m=problem.length_max_m,
            radio=RADIO,
            origin=Origin(36.6, -84.2, 300.0),
            scenario_hash="test",
            seed=1,
        ),
    )


@pytest.fixture(name="make_problem")
def _make_problem():
    return small_problem


@pytest.fixture(name="make_plan")
def _make_plan():
    return plan_of
