"""Small plans, made without a search."""

from __future__ import annotations

from dataclasses import replace

from jfto_msgs_py.plan_file import rounded
from jfto_msgs_py.records.certificate import Certificate
from jfto_msgs_py.records.plan import Origin, Plan, Uav, Waypoint
from jfto_msgs_py.scenario import Scenario
from jfto_planner.routing import PlanTerms, build_plan, certify


def side_by_side(scenario: Scenario, *, spacing_m: float = 100.0) -> Plan:
    """Each UAV flies east over two waypoints, its neighbours `spacing_m` beside it; certified."""
    fleet = scenario.fleet
    waypoints = tuple(
        Waypoint(2 * uav + leg, (100.0 * (leg + 1), spacing_m * uav, 50.0), yaw_deg=30.0 * uav)
        for uav in range(fleet.count)
        for leg in range(2)
    )
    plan = build_plan(
        [(2 * uav, 2 * uav + 1) for uav in range(fleet.count)],
        PlanTerms(
            waypoints=waypoints,
            uavs=tuple(
                Uav(
                    fleet.ids[uav],
                    fleet.p_max_dbm[uav],
                    fleet.energy_j[uav],
                    fleet.t_max_s[uav],
                    fleet.speed_mps[uav],
                    fleet.climb_mps[uav],
                    fleet.descent_mps[uav],
                    (0.0, spacing_m * uav, 0.0),
                )
                for uav in range(fleet.count)
            ),
            slot_count=scenario.mission.slot_count,
            horizon_s=None,
            k_min=scenario.network.k_min,
            delta=scenario.network.delta,
            d_min_m=scenario.mission.d_min_m,
            length_max_m=scenario.mission.length_max_m,
            radio=scenario.radio,
            origin=Origin(36.6, -84.2, 400.0),
            scenario_hash=scenario.scenario_hash(),
            seed=0,
        ),
    )
    plan = rounded(plan)
    certificate: Certificate = certify(plan)
    return replace(plan, certificate=certificate)
