"""How a scenario's routes are flown."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from jfto.pipeline.run import Run
from jfto.planning.flight import flight_of, tightened
from jfto.planning.problem import routing_problem
from jfto.planning.routes import certify_plan
from jfto.planning.scenario_file import load_scenario
from jfto.planning.survey import Survey
from jfto_msgs_py.errors import PlanError
from jfto_msgs_py.plan_file import plan_text, rounded
from jfto_msgs_py.records.plan import Plan


@pytest.mark.parametrize(
    ("mode", "name"),
    [("waypoints", "arducopter"), ("guided", "bezier"), ("straight", "constant_speed")],
)
def test_each_mode_has_its_time_model(tiny: Path, mode: str, name: str) -> None:
    """The plan's time model follows from trajectory.mode."""
    assert flight_of(load_scenario(tiny, [f"trajectory.mode={mode}"]).scenario).name == name


def test_waypoint_missions_are_the_default_and_say_how_they_are_timed(
    tiny_run: tuple[Path, Run],
) -> None:
    """The plan carries the model's name and parameters, and its certificate is clean."""
    plan = tiny_run[1].plan
    assert plan.time_model == "arducopter"
    assert plan.time_parameters["takeoff_m"] == 10.0
    assert plan.time_parameters["radius_m"] == 1.2
    assert certify_plan(plan).clean


def test_other_parameters_than_those_planned_with_are_found_out(
    tiny_run: tuple[Path, Run],
) -> None:
    """The certificate flies with the plan's parameters and compares the times."""
    plan = tiny_run[1].plan
    slower = {**plan.time_parameters, "jerk_mps3": 0.5}
    certificate = certify_plan(replace(plan, time_parameters=slower))
    assert {violation.kind for violation in certificate.violations} >= {"route"}


def test_a_guided_plan_is_clean_and_survives_its_file(tiny_guided: Plan) -> None:
    """One curve per UAV, sound by independent code, the same after writing and reading."""
    assert tiny_guided.time_model == "bezier"
    assert len(tiny_guided.trajectories) == len(tiny_guided.uavs)
    assert plan_text(rounded(tiny_guided)) == plan_text(tiny_guided)
    assert certify_plan(tiny_guided).clean


def _moved(record: dict[str, Any]) -> dict[str, Any]:
    control = np.array(record["control_m"])
    control[len(control) // 2, 3, 0] += 5.0
    return {**record, "control_m": control.tolist()}


def _hurried(record: dict[str, Any]) -> dict[str, Any]:
    return {
        **record,
        "duration_s": [0.7 * value for value in record["duration_s"]],
        "waypoint_s": [0.7 * value for value in record["waypoint_s"]],
    }


def _passed_later(record: dict[str, Any]) -> dict[str, Any]:
    return {**record, "waypoint_s": [value + 0.5 for value in record["waypoint_s"]]}


@pytest.mark.parametrize(
    ("change", "said"),
    [(_moved, "jumps by"), (_hurried, "are allowed"), (_passed_later, "of its route at")],
)
def test_a_curve_that_was_tampered_with_is_found_out(
    tiny_guided: Plan, change: Any, said: str
) -> None:
    """Jumps, broken limits and missed waypoints are violations, each said in words."""
    flying = max(range(len(tiny_guided.uavs)), key=lambda a: len(tiny_guided.routes[a].arrival_s))
    records = list(tiny_guided.trajectories)
    records[flying] = change(records[flying])
    certificate = certify_plan(replace(tiny_guided, trajectories=tuple(records)))
    assert not certificate.clean
    assert any(said in violation.message for violation in certificate.violations)


@pytest.mark.parametrize(
    "change",
    [
        {"kind": "circle"},
        {"duration_s": ["soon"]},
        {"duration_s": [0.0]},
        {"waypoint_s": [0.0]},
        {"control_m": []},
    ],
)
def test_a_record_that_is_no_trajectory_is_refused_by_name(
    tiny_guided: Plan, change: dict[str, Any]
) -> None:
    """What cannot be flown is an error of the plan that names the UAV."""
    flying = max(range(len(tiny_guided.uavs)), key=lambda a: len(tiny_guided.routes[a].arrival_s))
    records = list(tiny_guided.trajectories)
    records[flying] = {**records[flying], **change}
    with pytest.raises(PlanError, match=tiny_guided.uavs[flying].id):
        certify_plan(replace(tiny_guided, trajectories=tuple(records)))


def test_trajectories_and_time_model_must_belong_together(tiny_guided: Plan) -> None:
    """Curves under another time model, and the model without curves, are refused."""
    with pytest.raises(PlanError, match="time_model"):
        certify_plan(replace(tiny_guided, time_model="constant_speed", time_parameters={}))
    with pytest.raises(PlanError, match="0 trajectories"):
        certify_plan(replace(tiny_guided, trajectories=()))


def test_limits_that_were_broken_are_drawn_in(
    tiny: Path, tiny_survey: Survey, tiny_guided: Plan
) -> None:
    """A late UAV gets less time and a close pair more distance; kept limits stay."""
    problem = routing_problem(load_scenario(tiny, ["trajectory.mode=guided"]).scenario, tiny_survey)
    late = max(range(len(tiny_guided.uavs)), key=lambda a: max(tiny_guided.routes[a].arrival_s))
    end_s = max(tiny_guided.routes[late].arrival_s)
    uavs = list(tiny_guided.uavs)
    uavs[late] = replace(uavs[late], t_max_s=end_s - 2.0)
    plan = replace(tiny_guided, uavs=tuple(uavs), d_min_m=1000.0)
    again = tightened(problem, replace(plan, certificate=certify_plan(plan)))
    assert problem.t_max_s[late] - again.t_max_s[late] == pytest.approx(3.0)
    assert np.delete(again.t_max_s, late).tolist() == np.delete(problem.t_max_s, late).tolist()
    assert again.d_min_m > problem.d_min_m
    assert np.array_equal(again.reach_m, problem.reach_m)
