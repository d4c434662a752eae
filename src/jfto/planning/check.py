"""A plan checked anew from its file, with height above the ground where the terrain is at hand."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from jfto.planning.problem import ground_rule, home_ground
from jfto.planning.routes import certify_plan
from jfto.planning.scenario_file import SCENARIO_NAME
from jfto.planning.scenario_of_plan import load_scenario_for
from jfto.planning.survey import Survey, judged
from jfto.planning.terrain import known_ground
from jfto_msgs_py.errors import InputError, JftoError, PlanError
from jfto_msgs_py.plan_file import read_plan
from jfto_msgs_py.records.plan import Plan
from jfto_msgs_py.scenario import Scenario
from jfto_world.terrain import Dem

if TYPE_CHECKING:
    from jfto_planner.coverage import Coverage

# A plan's heights are above its origin: so far off, the terrain is another one.
_SAME_DEG, _SAME_M = 1e-6, 0.5


@dataclass(frozen=True)
class Checked:
    """A plan with a new certificate, and what is known of the ground below, in words.

    `coverage` is what the photos show of the plan's area, None where that was not judged.
    """

    plan: Plan
    ground: str
    coverage: Coverage | None = None


def check_plan(path: Path, scenario_file: Path | None = None) -> Checked:
    """The plan of a file, checked anew, and its photos judged where the ground is known.

    The terrain is that of `scenario_file`, else of the scenario.yaml beside the plan. Raises
    PlanError that names the file.
    """
    plan = read_plan(path)
    known = _ground(plan, path, scenario_file)
    try:
        if isinstance(known, str):
            plan = replace(plan, certificate=certify_plan(plan))
            return Checked(plan, f"not checked: {known}")
        scenario, dem = known
        ground = ground_rule(scenario, plan.waypoints, dem)
        home = home_ground(scenario, dem) if plan.homes else None
        certificate = certify_plan(plan, ground, home)
    except InputError as error:
        raise PlanError(f"{path}: {error}") from None
    where = "routes and ways home" if ground and home else "routes" if ground else "ways home"
    checked = f"{where} checked over {dem.description}" if ground or home else "nothing to check"
    return Checked(replace(plan, certificate=certificate), checked, _coverage(plan, scenario, dem))


def _coverage(plan: Plan, scenario: Scenario, dem: Dem) -> Coverage | None:
    """What photos of a plan show of its area; drawn waypoints are to show none."""
    if scenario.waypoints.source not in ("coverage", "file"):
        return None
    found = Survey(replace(dem, area=plan.area), plan.waypoints, None)
    return judged(found, scenario).coverage


def _ground(plan: Plan, path: Path, scenario_file: Path | None) -> tuple[Scenario, Dem] | str:
    """Scenario and terrain of a plan, or why there are none."""
    beside = path.with_name(SCENARIO_NAME)
    if scenario_file is None and not beside.exists():
        return f"no {SCENARIO_NAME} beside the plan; name one with --scenario"
    try:
        loaded = load_scenario_for(path, scenario_file)
        if scenario_file is None and loaded.scenario.scenario_hash() != plan.scenario_hash:
            return f"{beside} is not the scenario of this plan; name it with --scenario"
        dem = known_ground(loaded)
    except JftoError as error:
        return " ".join(str(error).split())
    if dem is None:
        return "the scenario's terrain is unknown"
    here, there = plan.origin, dem.origin
    apart_deg = max(abs(here.lat_deg - there.lat_deg), abs(here.lon_deg - there.lon_deg))
    if apart_deg > _SAME_DEG or abs(here.alt_m - there.alt_m) > _SAME_M:
        return "the terrain has another origin than the plan"
    return loaded.scenario, dem
