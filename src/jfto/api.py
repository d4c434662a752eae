"""The Python face: from a scenario to a plan, and what its network is worth.

>>> import jfto
>>> plan = jfto.plan("config/demo.yaml", seed=1)
>>> print(jfto.compare(plan).table())

Below it are the rooms for people who bring arrays: `jfto_topology.algorithms`, `jfto_power`,
`jfto_planner`. Nothing here needs ROS or a vehicle.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from jfto.console.progress import SILENT, Progress
from jfto.planning.scenario_file import LoadedScenario
from jfto.planning.scenario_file import load_scenario as _load
from jfto_msgs_py.errors import InfeasibleError, InputError
from jfto_msgs_py.records.plan import Plan
from jfto_msgs_py.whole_numbers import checked_seed

if TYPE_CHECKING:
    from jfto.analysis.comparison import Comparison
    from jfto_planner.coverage.plan_coverage import Coverage
    from jfto_power.allocation import Allocation
    from jfto_topology.algorithms.ctop import Topology

ScenarioLike = str | Path | LoadedScenario


def load_scenario(path: str | Path, overrides: Mapping[str, Any] | None = None) -> LoadedScenario:
    """Scenario of a parameter file.

    Parameters
    ----------
    path
        ROS 2 parameter file, as in `config/`.
    overrides
        Values by key on top of the file's, such as ``{"network.k_min": 1}``.

    Returns
    -------
    LoadedScenario
        The validated scenario, and the file that its paths are resolved against.

    Raises
    ------
    ScenarioError
        Lists every unknown key and every value out of range.
    InputError
        `path` is no path, or `overrides` no mapping.
    """
    if not isinstance(path, str | Path):
        raise InputError(f"load_scenario takes the path of a parameter file, not {_kind(path)}.")
    if not isinstance(overrides or {}, Mapping):
        raise InputError(
            f'overrides is {_kind(overrides)}; give values by key, such as {{"network.k_min": 1}}.'
        )
    given = [
        f"{k}={v if isinstance(v, str) else json.dumps(v)}" for k, v in (overrides or {}).items()
    ]
    return _load(path, given, "overrides")


def cover(scenario: ScenarioLike, progress: Progress = SILENT) -> Coverage:
    """Camera waypoints over a scenario's ground, with their certificate.

    Parameters
    ----------
    scenario
        A loaded scenario or the path of one; waypoints of any source are judged.
    progress
        Hears of stages and shares done.

    Returns
    -------
    Coverage
        Waypoints (ENU metres about the origin, yaw and pitch in degrees) and the share seen.

    Raises
    ------
    InputError
        The terrain, the camera or given waypoints cannot be used.
    """
    from jfto.planning.survey import judged, survey

    loaded = _loaded(scenario)
    found = judged(survey(loaded, progress), loaded.scenario, progress).coverage
    assert found is not None
    return found


def plan(
    scenario: ScenarioLike,
    *,
    seed: int | None = None,
    warm_start: Plan | None = None,
    progress: Progress = SILENT,
) -> Plan:
    """Routes over a scenario's waypoints under its radio rules, timed as flown, and certified.

    One flight, whether it does or not: `plan_sorties` makes several where it does not.

    Parameters
    ----------
    scenario
        A loaded scenario or the path of one.
    seed
        Seed of the search, the scenario's where None; the same gives the same bytes.
    warm_start
        An earlier plan of the same waypoints and fleet to improve.
    progress
        Hears of stages and shares done.

    Returns
    -------
    Plan
        With its `certificate`, which names every violation where the rules cannot be kept.

    Raises
    ------
    InfeasibleError
        The starts or the wind leave no plan at all, missions do not hold it, or sorties.count asks
        for several.
    InputError
        Terrain, waypoints, `seed` (0 to 2147483647) or `warm_start` cannot be used.
    """
    from jfto.planning.routes import plan_routes
    from jfto.planning.survey import survey

    loaded = _seeded(_loaded(scenario), seed)
    if loaded.scenario.sorties.count > 1:
        raise InfeasibleError(
            f"sorties.count is {loaded.scenario.sorties.count}, and this is one plan.",
            cures=("jfto.plan_sorties(scenario)", "sorties.count 1"),
        )
    return plan_routes(loaded.scenario, survey(loaded, progress), progress, warm_start).plan


def plan_sorties(
    scenario: ScenarioLike, *, seed: int | None = None, progress: Progress = SILENT
) -> tuple[Plan, ...]:
    """Plans of as few flights as are found to do, or of sorties.count; one where one does.

    Parameters
    ----------
    scenario
        A loaded scenario or the path of one; its part sorties says how many, and from where.
    seed
        Seed of the searches, the scenario's where None; the same gives the same bytes.
    progress
        Hears of stages and shares done.

    Returns
    -------
    tuple of Plan
        In the order in which they are flown; several are clean, each with waypoints of its own. One
        alone may break rules, which its `certificate` names, where no division does either.

    Raises
    ------
    InfeasibleError
        There is nothing to show.
    InputError
        Terrain, waypoints or `seed` (0 to 2147483647) cannot be used.
    """
    from jfto.planning.sorties import plan_sorties as planned_sorties
    from jfto.planning.survey import survey

    loaded = _seeded(_loaded(scenario), seed)
    return planned_sorties(loaded.scenario, survey(loaded, progress), progress).plans


def topology(plan: Plan) -> Topology:
    """Neighbours and transmit-power intervals of every slot by C-TOP (Alg. 2).

    Parameters
    ----------
    plan
        A plan; its positions, radio, K_min and δ are used.

    Returns
    -------
    Topology
        `adjacency` (N + 1, A, A), power bounds (N + 1, A) in W, and what could not be kept.

    Raises
    ------
    InputError
        The plan's arrays make no network.
    """
    from jfto.planning.network import network_of, topology_of

    plan = _checked(plan, "topology")
    return topology_of(plan, network_of(plan))


def power(plan: Plan) -> Allocation:
    """Transmit powers that maximise throughput within C-TOP's intervals and the energy (P4).

    Parameters
    ----------
    plan
        A plan; its energy budgets are used.

    Returns
    -------
    Allocation
        `power_w` (N + 1, A); where the energy does not last, of the slots that it lasts for.

    Raises
    ------
    InputError
        The plan's arrays make no network.
    """
    from jfto.planning.network import network_of, power_of, topology_of

    plan = _checked(plan, "power")
    network = network_of(plan)
    return power_of(plan, network, topology_of(plan, network))[0]


def compare(plan: Plan, *, n_dc: int | None = None, progress: Progress = SILENT) -> Comparison:
    """C-TOP with exact powers beside MTP, A-LMST and CPAPO on one plan.

    Parameters
    ----------
    plan
        A plan.
    n_dc
        First slot that counts for the connectivity rate ξ; None for 3/10 of the slots, the paper's
        45 of 150.
    progress
        Hears of stages.

    Returns
    -------
    Comparison
        Links, powers and metrics of each; `table()` for reading.

    Raises
    ------
    InputError
        The plan's arrays make no network.
    """
    from jfto.analysis.comparison import compare as compared

    plan = _checked(plan, "compare")
    first = round(0.3 * plan.slots.count) if n_dc is None else n_dc
    return compared(plan, first, progress)


def report(
    scenario: ScenarioLike, plan: Plan, directory: str | Path, progress: Progress = SILENT
) -> Path:
    """Comparison, figures and one offline HTML page of a plan.

    Parameters
    ----------
    scenario
        The plan's scenario, for terrain and camera.
    plan
        A plan.
    directory
        Where to write; made if it is not there.
    progress
        Hears of stages.

    Returns
    -------
    Path
        The page.

    Raises
    ------
    JftoError
        The terrain cannot be read or the directory not be written.
    """
    from jfto.pipeline.run import Pipeline, Run, save_plan

    plan = _checked(plan, "report")
    directory = Path(directory)
    directory.mkdir(parents=True, exist_ok=True)
    pipeline = Pipeline(_loaded(scenario), directory, progress)
    path = save_plan(plan, directory / "plan.json")
    page = pipeline.report(Run(plan, path)).report
    assert page is not None
    return page


def _loaded(scenario: ScenarioLike) -> LoadedScenario:
    if isinstance(scenario, LoadedScenario):
        return scenario
    if not isinstance(scenario, str | Path):
        raise InputError(
            f"A scenario is one of jfto.load_scenario or the path of one, not {_kind(scenario)}."
        )
    return _load(scenario)


def _seeded(loaded: LoadedScenario, seed: int | None) -> LoadedScenario:
    """The scenario with another seed of its search, or as it is."""
    if seed is None:
        return loaded
    search = replace(loaded.scenario.search, seed=checked_seed(seed))
    return replace(loaded, scenario=replace(loaded.scenario, search=search))


def _checked(plan: Plan, function: str) -> Plan:
    """`plan`, unless it is something else: a path, a scenario or a coverage."""
    if not isinstance(plan, Plan):
        raise InputError(
            f"jfto.{function} takes a plan of jfto.plan or of jfto_msgs_py.plan_file.read_plan, "
            f"not {_kind(plan)}."
        )
    return plan


def _kind(value: object) -> str:
    return f"{value!r}" if isinstance(value, str | int | float | None) else type(value).__name__
