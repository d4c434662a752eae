"""The scenario that a plan says of itself."""

from __future__ import annotations

import pytest

from jfto.planning.scenario_file import UNKNOWN_TERRAIN, load_scenario
from jfto.planning.scenario_of_plan import load_scenario_for, scenario_values
from jfto.planning.terrain import known_ground, load_ground
from jfto_msgs_py.errors import TerrainError
from jfto_msgs_py.plan_file import write_plan


def test_a_plan_says_what_its_nodes_need(tiny, tiny_run) -> None:
    """Fleet, radio, rules, slots and how it is flown are those that it was planned with."""
    plan = tiny_run[1].plan
    planned, said = load_scenario(tiny).scenario.values(), scenario_values(plan)
    for name, value in said.items():
        if name.startswith(("fleet.", "radio.", "network.", "mission.", "trajectory.")) and (
            name not in {"fleet.speed_mps", "mission.horizon_s"}
        ):
            assert (
                value == pytest.approx(planned[name])
                if _is_number(value)
                else (value == planned[name])
            ), name
    # Speeds are those that the wind leaves, the horizon what the plan took.
    assert said["fleet.speed_mps"] == tuple(uav.speed_mps for uav in plan.uavs)
    assert said["mission.horizon_s"] == plan.slots.horizon_s


def _is_number(value) -> bool:
    return isinstance(value, int | float)


def test_guided_plans_say_so(tiny_guided, tmp_path) -> None:
    """Mode and limits of the curves."""
    write_plan(tiny_guided, tmp_path / "plan.json")
    trajectory = load_scenario_for(tmp_path / "plan.json").scenario.trajectory
    assert trajectory.mode == "guided"
    assert trajectory.curve_tilt_deg == tiny_guided.time_parameters["tilt_deg"]


def test_ground_that_nobody_knows_is_not_planned_over(tiny_run, tmp_path) -> None:
    """Missions are not held against it, and a planner says what is missing."""
    write_plan(tiny_run[1].plan, tmp_path / "alone.json")
    loaded = load_scenario_for(tmp_path / "alone.json")
    assert loaded.scenario.terrain.source == UNKNOWN_TERRAIN
    assert loaded.node_options == {"mavlink_bridge": {"check_terrain": False}}
    assert known_ground(loaded) is None
    with pytest.raises(TerrainError, match="Name an elevation model"):
        load_ground(loaded)


def test_what_is_set_on_the_command_line_wins(tiny_run, tmp_path) -> None:
    """Also a terrain, which is then checked."""
    write_plan(tiny_run[1].plan, tmp_path / "alone.json")
    overrides = ("terrain.source=jacksboro", "network.delta=3")
    loaded = load_scenario_for(tmp_path / "alone.json", None, overrides)
    assert loaded.scenario.network.delta == 3
    assert loaded.node_options == {}
