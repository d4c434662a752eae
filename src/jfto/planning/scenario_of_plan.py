"""The scenario that a plan is flown under: the one beside it, or what the plan itself says."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import Any

from jfto.planning.flight import ARDUCOPTER_KEYS, CURVE_KEYS
from jfto.planning.scenario_file import (
    SCENARIO_NAME,
    UNKNOWN_TERRAIN,
    LoadedScenario,
    load_scenario,
    read_overrides,
)
from jfto_msgs_py.errors import ScenarioError
from jfto_msgs_py.plan_file import read_plan
from jfto_msgs_py.records.plan import Plan
from jfto_msgs_py.scenario import Given, make_scenario

_TRAJECTORY_KEYS = {"arducopter": ARDUCOPTER_KEYS, "bezier": CURVE_KEYS}
_MODES = {"arducopter": "waypoints", "bezier": "guided", "constant_speed": "straight"}


def load_scenario_for(
    plan_file: Path, scenario_file: Path | None = None, overrides: tuple[str, ...] = ()
) -> LoadedScenario:
    """Scenario that the plan in a file is flown under, with `key=value` overrides on top.

    That is `scenario_file`, else the scenario.yaml beside the plan, else what the plan itself says:
    fleet, radio, rules and slots, over unknown terrain. Raises PlanError and ScenarioError.
    """
    beside = plan_file.with_name(SCENARIO_NAME)
    if scenario_file is None and beside.exists():
        scenario_file = beside
    if scenario_file is not None:
        return load_scenario(scenario_file, overrides)
    values = {
        name: Given(list(value) if isinstance(value, tuple) else value, str(plan_file))
        for name, value in scenario_values(read_plan(plan_file)).items()
    }
    problems: list[str] = []
    options: dict[str, dict[str, Any]] = {}
    try:
        scenario = make_scenario([values, read_overrides(overrides, options, problems)])
    except ScenarioError as error:
        raise ScenarioError([*problems, *error.problems]) from None
    if problems:
        raise ScenarioError(problems)
    if scenario.terrain.source == UNKNOWN_TERRAIN:
        # No mission can be held against ground that nobody knows.
        options.setdefault("mavlink_bridge", {})["check_terrain"] = False
    return LoadedScenario(scenario, plan_file, options)


def scenario_values(plan: Plan) -> dict[str, Any]:
    """What a plan says of its scenario, by dotted key."""
    uavs, places = plan.uavs, plan.positions_m[..., :2].reshape(-1, 2)
    values: dict[str, Any] = {
        "terrain.source": UNKNOWN_TERRAIN,
        "terrain.center_deg": (plan.origin.lat_deg, plan.origin.lon_deg),
        "terrain.size_m": tuple(max(2 * float(abs(axis).max()), 20.0) for axis in places.T),
        "fleet.count": len(uavs),
        "fleet.ids": tuple(uav.id for uav in uavs),
        "starts.count": len(uavs),
        "starts.positions_m": tuple(axis for uav in uavs for axis in uav.start_m[:2]),
        "network.k_min": plan.k_min,
        "network.delta": plan.delta,
        "network.topology": plan.topology,
        "mission.d_min_m": plan.d_min_m,
        "mission.length_max_m": plan.length_max_m,
        "mission.slot_count": plan.slots.count,
        "mission.horizon_s": plan.slots.horizon_s,
        "search.seed": plan.seed,
        "trajectory.mode": _MODES[plan.time_model],
    }
    for key in ("p_max_dbm", "energy_j", "t_max_s", "speed_mps", "climb_mps", "descent_mps"):
        values[f"fleet.{key}"] = tuple(getattr(uav, key) for uav in uavs)
    batteries = [uav.battery for uav in uavs]
    if any(batteries):
        for key, name in (
            ("battery_wh", "capacity_wh"),
            ("hover_power_w", "hover_power_w"),
            ("cruise_power_w", "cruise_power_w"),
        ):
            values[f"fleet.{key}"] = tuple(getattr(one, name, 0.0) for one in batteries)
        values["fleet.battery_reserve_percent"] = next(
            one.reserve_percent for one in batteries if one
        )
    values |= {f"radio.{key}": value for key, value in dataclasses.asdict(plan.radio).items()}
    keys = _TRAJECTORY_KEYS.get(plan.time_model, {})
    for name, value in plan.time_parameters.items():
        if name in keys:
            values[f"trajectory.{keys[name]}"] = value
    return values
