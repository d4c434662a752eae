"""The examples do what their first lines say, from any folder and without a warning."""

from __future__ import annotations

import re
import runpy
import sys
from pathlib import Path
from typing import Any

import nbformat
import pytest
from nbclient import NotebookClient

import jfto_planner
from jfto.planning.sorties import faults_together
from jfto_msgs_py.plan_file import read_plan

ROOT = Path(__file__).parents[2]
EXAMPLES = ROOT / "examples"
SCRIPTS = sorted(EXAMPLES.glob("*.py"))
NOTEBOOKS = sorted(EXAMPLES.glob("*.ipynb"))


@pytest.fixture
def run(monkeypatch, tmp_path, capsys):
    """Run an example as a program, from another folder; its output."""

    def run_it(name: str, *arguments: str) -> str:
        monkeypatch.chdir(tmp_path)
        monkeypatch.setattr(sys, "argv", [name, *arguments])
        runpy.run_path(str(EXAMPLES / name), run_name="__main__")
        return capsys.readouterr().out

    return run_it


@pytest.mark.slow
def test_a_scenario_of_ones_own(run, tmp_path):
    """Photos that see the ground, a clean plan that is kept, four algorithms side by side."""
    out = run("own_scenario.py", str(EXAMPLES / "valley.yaml"), str(tmp_path))
    assert float(re.search(r"photos see ([\d.]+) %", out)[1]) > 99
    assert "clean: True" in out
    assert all(name in out for name in ("MTP", "A-LMST", "CPAPO", "C-TOP"))
    assert read_plan(tmp_path / "plan.json").clean


@pytest.mark.slow
def test_several_sorties(run, tmp_path):
    """More than one, each clean, with files that belong together."""
    out = run("several_sorties.py", str(EXAMPLES / "valley.yaml"), str(tmp_path / "one"))
    assert "sortie 1 of 1" in out
    out = run("several_sorties.py")
    folder, count = re.search(r"(\S+) has (\d+) plans", out).groups()
    assert int(count) > 1
    assert out.count("clean: True") == int(count)
    plans = [read_plan(path) for path in sorted(Path(folder).glob("plan-*.json"))]
    assert faults_together(plans) == ()


@pytest.mark.parametrize(("name", "count"), [("waypoints.csv", 6), ("waypoints.geojson", 4)])
def test_waypoints_of_ones_own(run, name, count):
    """Every waypoint of either kind of file is on one route."""
    out = run("own_waypoints.py", str(EXAMPLES / name))
    assert f"{name}: {count} waypoints" in out
    visited = re.findall(r"(\d+) at \d+ s", out)
    assert sorted(map(int, visited)) == list(range(count))
    assert "in one piece throughout: True" in out


def test_topology_controls_on_tracks(run):
    """One line for each algorithm; C-TOP keeps K_min = 1 and one piece, at less than full power."""
    lines = run("compare_topologies.py").splitlines()
    assert [line.split()[0] for line in lines] == ["MTP", "A-LMST", "CPAPO", "C-TOP"]
    assert "neighbours 1 to" in lines[-1]
    assert "hops  inf" not in lines[-1]
    spent_j = [float(line.split()[-4]) for line in lines]
    assert spent_j[-1] < spent_j[0]


def test_power_for_a_given_graph(run):
    """The allocation carries more than the least powers, and no budget is overdrawn."""
    out = run("allocate_power.py")
    least, best = (float(value) for value in re.findall(r"([\d.]+) Mb/s$", out, re.MULTILINE)[:2])
    assert best > least
    spent = re.findall(r"spends +([\d.]+) of (\d+) J", out)
    assert len(spent) == 4
    assert all(float(used) <= float(budget) for used, budget in spent)


@pytest.mark.slow
def test_missions_go_on_board(run):
    """Each of the three simulated vehicles holds its mission and verifies."""
    out = run("upload_missions.py")
    assert len(re.findall(r"^uav\d: \d+ items on board", out, re.MULTILINE)) == 3
    assert out.count("verified, item by item") == 3


def test_a_bag_is_read(run):
    """Counts, tracks and powers of four UAVs."""
    out = run("read_a_bag.py")
    assert "1696 messages" in out
    assert len(re.findall(r"^/uav\d/pose: [\d.]+ m flown", out, re.MULTILINE)) == 4
    assert len(re.findall(r"^/uav\d/jfto/tx_power: ", out, re.MULTILINE)) == 4


@pytest.mark.slow
@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_notebooks_run_from_top_to_bottom(path):
    """No cell fails; what is kept in the repository has no outputs."""
    notebook = nbformat.read(path, as_version=4)
    cells = [cell for cell in notebook.cells if cell.cell_type == "code"]
    assert all(not cell.outputs and cell.execution_count is None for cell in cells)
    NotebookClient(
        notebook, timeout=300, kernel_name="python3", resources={"metadata": {"path": EXAMPLES}}
    ).execute()


def test_a_problem_takes_no_more_than_five_lines():
    """The lines in the docstring of RoutingProblem find sound routes, and these certify."""
    lines = re.findall(r">>> (.*)", jfto_planner.RoutingProblem.__doc__)
    assert len(lines) <= 5
    names: dict[str, Any] = {}
    exec("\n".join(lines), names)
    assert names["found"].feasible
    plan = jfto_planner.plan_of(names["problem"], names["found"].routes)
    assert jfto_planner.certify(plan).clean
    assert plan.total_length_m == pytest.approx(names["found"].length_m)


def test_examples_are_short_and_opened_in_the_pages():
    """At most 60 lines each, and each is linked from a page or the README."""
    pages = "".join(path.read_text(encoding="utf-8") for path in (ROOT / "docs").rglob("*.md"))
    for path in [*SCRIPTS, *NOTEBOOKS]:
        assert f"examples/{path.name})" in pages, f"{path.name} is on no page"
    for path in SCRIPTS:
        assert len(path.read_text(encoding="utf-8").splitlines()) <= 60, path.name
