"""The Python face: few lines from a scenario to figures, light to import, checked by name."""

from __future__ import annotations

import importlib
import pkgutil
import subprocess
import sys
from pathlib import Path

import pytest

import jfto
from jfto_msgs_py.errors import InputError, ScenarioError

TINY = Path(__file__).parents[1] / "data/scenario/tiny.yaml"


@pytest.fixture(scope="module")
def plan():
    """A small plan, made as the docstring of the face shows."""
    return jfto.plan(TINY, seed=1)


def test_a_plan_has_its_certificate_and_its_seed(plan):
    """The seed that was given is the plan's, and the same gives the same plan."""
    assert plan.certificate.clean
    assert plan.seed == 1
    again = jfto.plan(jfto.load_scenario(TINY), seed=1)
    assert again.routes == plan.routes


def test_topology_and_power_belong_to_the_plan(plan):
    """Shapes are slots by UAVs; powers lie within the topology's intervals."""
    topology, allocation = jfto.topology(plan), jfto.power(plan)
    slots, uavs = plan.slots.count + 1, len(plan.uavs)
    assert topology.adjacency.shape == (slots, uavs, uavs)
    assert allocation.power_w.shape == (slots, uavs)
    assert (allocation.power_w >= topology.p_min_w * (1 - 1e-9)).all()


def test_the_comparison_reads_as_a_table(plan):
    """One line per algorithm under a heading with units."""
    lines = jfto.compare(plan).table().splitlines()
    assert "Mb/s" in lines[0]
    names = [line.split()[0] for line in lines[1:7]]
    assert names == ["MTP", "A-LMST", "CPAPO", "C-TOP", "C-TOP", "C-TOP"]
    assert lines[6].startswith("C-TOP elastic")


@pytest.mark.slow
def test_a_report_is_one_page_beside_its_plan(plan, tmp_path):
    """The page is offline HTML, and its figures and comparison lie in the same directory."""
    page = jfto.report(TINY, plan, tmp_path / "first")
    assert page.read_text(encoding="utf-8").lower().startswith("<!doctype html>")
    assert {"plan.json", "figures", "comparison.json"} <= {
        each.name for each in page.parent.iterdir()
    }


def test_overrides_are_values_and_wrong_ones_are_refused():
    """Lists and numbers as Python has them; unknown keys are errors as in the file."""
    scenario = jfto.load_scenario(TINY, {"fleet.speed_mps": [7.0], "search.seed": 5}).scenario
    assert scenario.fleet.speed_mps[0] == 7.0
    assert scenario.search.seed == 5
    with pytest.raises(ScenarioError, match="Did you mean"):
        jfto.load_scenario(TINY, {"network.k_mim": 1})
    with pytest.raises(ScenarioError, match=r"^((?!--set).)*overrides((?!--set).)*$"):
        jfto.load_scenario(TINY, {"network.k_min": -1})


@pytest.mark.parametrize("seed", [-1, 2**31, "a", 1.5, True])
def test_seeds_are_those_of_the_command_line(seed):
    """Whole numbers from 0 to 2147483647, as `--seed` takes them."""
    with pytest.raises(InputError, match="seed is"):
        jfto.plan(TINY, seed=seed)


def test_what_is_no_scenario_or_plan_is_refused():
    """The message says what the function takes."""
    for wrong in (3, None, {}):
        with pytest.raises(InputError, match="path of"):
            jfto.load_scenario(wrong)
    with pytest.raises(InputError, match="by key"):
        jfto.load_scenario(TINY, "network.k_min=2")
    for takes_scenario in (jfto.plan, jfto.cover):
        with pytest.raises(InputError, match="not 5"):
            takes_scenario(5)
    for takes_plan in (jfto.topology, jfto.power, jfto.compare):
        for wrong in ("small.json", jfto.load_scenario(TINY)):
            with pytest.raises(InputError, match=r"takes a plan of jfto\.plan"):
                takes_plan(wrong)


def test_names_that_load_late_are_listed():
    """`dir` has what a package exports, and nothing that it only uses."""
    assert {"plan", "cover", "compare", "__version__"} <= set(dir(jfto))
    assert not {"TYPE_CHECKING", "lazy_names"} & set(dir(jfto))


def test_waypoints_of_any_origin_are_judged():
    """What drawn waypoints show of the area is certified as that of computed ones is."""
    drawn = jfto.load_scenario(TINY, {"waypoints.source": "uniform", "waypoints.count": 5})
    found = jfto.cover(drawn)
    assert len(found.waypoints) == 5
    assert 0 <= found.certificate.seen_once < 1


def test_import_loads_nothing_heavy():
    """`import jfto` alone brings no numpy, torch or ROS."""
    code = (
        "import sys, jfto; print(sorted({'numpy', 'torch', 'rclpy', 'click'} & set(sys.modules)))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


ROOMS = ("jfto", "jfto_planner", "jfto_topology", "jfto_power", "jfto_world", "jfto_msgs_py")


@pytest.mark.parametrize("room", [*ROOMS, "jfto_mavlink", "jfto_sim"])
def test_what_packages_export_is_there(room):
    """Every name of an `__all__` exists."""
    package = importlib.import_module(room)
    found = [name for _, name, is_package in pkgutil.walk_packages(package.__path__, f"{room}.")
             if is_package]  # fmt: skip
    for name in [room, *found]:
        module = importlib.import_module(name)
        exported = getattr(module, "__all__", [])
        assert all(hasattr(module, each) for each in exported), name
