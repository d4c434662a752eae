"""The whole pipeline on a small scene."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import numpy as np
import pytest

from jfto.analysis.comparison import FORM_NAMES
from jfto.pipeline.directory import make_run_directory
from jfto.pipeline.run import Run, rebuild, save_plan
from jfto.planning.routes import plan_routes
from jfto.planning.scenario_file import load_scenario
from jfto.planning.survey import survey
from jfto_msgs_py.plan_file import plan_text, read_plan
from support.runs import run_all


def test_a_run_leaves_every_result_in_its_directory(tiny_run: tuple[Path, Run]) -> None:
    """Scenario, plan, comparison, figures for screen and print, and the report are all there."""
    directory, _ = tiny_run
    names = {str(path.relative_to(directory)) for path in directory.rglob("*") if path.is_file()}
    figures = {"routes", "topology", "throughput", "degree_energy"}
    assert names >= {"scenario.yaml", "plan.json", "comparison.json", "comparison.csv", "slots.csv"}
    assert names >= {f"figures/{stem}.{kind}" for stem in figures for kind in ("png", "pdf")}
    assert "report.html" in names
    assert not any(name.endswith(".tmp") for name in names)


def test_the_plan_is_verified_and_visits_every_waypoint_once(tiny_run: tuple[Path, Run]) -> None:
    """The certificate of a run's plan is clean and its routes are a partition of the waypoints."""
    _, run = tiny_run
    assert run.plan.certificate is not None
    assert run.plan.certificate.clean
    visited = sorted(number for route in run.plan.routes for number in route.waypoint_ids)
    assert visited == sorted(waypoint.id for waypoint in run.plan.waypoints)


@pytest.mark.slow
def test_same_scenario_and_seed_give_the_same_bytes(
    tiny: Path, tiny_run: tuple[Path, Run], tmp_path: Path
) -> None:
    """A second run writes byte-identical plan, comparison and slots, whatever the workers."""
    first, _ = tiny_run
    second = make_run_directory(tmp_path / "again")
    loaded = load_scenario(tiny, ["search.workers=1"])
    run_all(loaded, second)
    for name in ("plan.json", "comparison.json", "slots.csv", "figures/routes.png"):
        assert (first / name).read_bytes() == (second / name).read_bytes(), name


def test_another_seed_is_recorded_in_the_plan(tiny: Path) -> None:
    """The seed goes into the plan, and does not change the hash of the scenario."""
    loaded = load_scenario(tiny, ["search.seed=7"])
    plan = plan_routes(loaded.scenario, survey(loaded)).plan
    assert plan.seed == 7
    assert plan.scenario_hash == load_scenario(tiny).scenario.scenario_hash()


def test_the_resolved_scenario_stands_for_the_original(
    tiny: Path, tiny_run: tuple[Path, Run]
) -> None:
    """The scenario of a run directory resolves to the very same values."""
    directory, _ = tiny_run
    resolved = load_scenario(directory / "scenario.yaml").scenario
    assert resolved.values() == load_scenario(tiny).scenario.values()


@pytest.mark.slow
def test_a_report_is_rebuilt_from_its_directory(tiny_run: tuple[Path, Run]) -> None:
    """Scenario and plan are enough to write the same report and figures again."""
    directory, _ = tiny_run
    before = (directory / "report.html").read_bytes()
    (directory / "report.html").unlink()
    outcome = rebuild(directory)
    assert outcome.report is not None
    assert outcome.report.read_bytes() == before


def test_comparison_files_agree(tiny_run: tuple[Path, Run]) -> None:
    """CSV and JSON hold the same throughput for each algorithm, and the paper's beside it."""
    directory, run = tiny_run
    facts = json.loads((directory / "comparison.json").read_text())
    with (directory / "comparison.csv").open(newline="") as file:
        rows = {row["algorithm"]: row for row in csv.DictReader(file)}
    assert set(rows) == {"MTP", "A-LMST", "CPAPO", *FORM_NAMES.values()}
    for name, row in rows.items():
        assert float(row["throughput_mbps"]) == round(
            facts["algorithms"][name]["throughput_mbps"], 3
        )
    for name in FORM_NAMES.values():
        assert float(rows[name]["paper_decades"]) == 1930.0
    assert run.comparison is not None
    slots = (directory / "slots.csv").read_text().splitlines()
    assert len(slots) == run.plan.slots.count + 2


def test_ctop_keeps_the_budget_and_the_neighbour_rule(tiny_run: tuple[Path, Run]) -> None:
    """No UAV spends more than its energy, and nobody has fewer than K_min active neighbours."""
    _, run = tiny_run
    assert run.comparison is not None
    ours = run.comparison.ours
    budget = np.array([uav.energy_j for uav in run.plan.uavs])
    assert (ours.energy_j <= budget * (1 + 1e-9)).all()
    assert ours.degree.min() >= run.plan.k_min
    assert (ours.active.links <= ours.linked.links).all()


@pytest.mark.slow
def test_an_infeasible_run_has_its_report_too(tiny: Path, tmp_path: Path) -> None:
    """Where no energy lasts, nothing has any throughput, and the page lists what is violated."""
    run = run_all(load_scenario(tiny, ["fleet.energy_j=0.001"]), tmp_path)
    assert run.plan_path == tmp_path / "plan.infeasible.json"
    assert run.comparison is not None
    assert run.comparison.throughput_ratios == {}
    assert run.report is not None
    page = run.report.read_text(encoding="utf-8")
    assert "Infeasible as planned" in page
    assert "<h3>Violations</h3>" in page


def test_an_infeasible_plan_never_replaces_a_clean_one(
    tiny_run: tuple[Path, Run], tmp_path: Path
) -> None:
    """A plan without a clean certificate goes to .infeasible.json and leaves plan.json alone."""
    from dataclasses import replace

    _, run = tiny_run
    path = save_plan(run.plan, tmp_path / "plan.json")
    assert path == tmp_path / "plan.json"
    unchecked = replace(run.plan, certificate=None)
    assert save_plan(unchecked, path) == tmp_path / "plan.infeasible.json"
    assert path.read_text() == plan_text(run.plan)
    assert read_plan(path).routes == run.plan.routes
