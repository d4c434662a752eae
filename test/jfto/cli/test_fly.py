"""jfto fly: what a plan is flown under, and what is refused before anything is done."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest

from jfto.cli import main


@pytest.fixture
def plan(tiny_run, tmp_path) -> Path:
    """The tiny scene's plan alone, no scenario beside it."""
    return Path(shutil.copy(tiny_run[0] / "plan.json", tmp_path / "alone.json"))


@pytest.mark.slow
def test_a_plan_alone_is_enough(plan, tmp_path, capsys) -> None:
    """Checked, compared and reported; the terrain is said to be unknown, and no map is drawn."""
    out = tmp_path / "run"
    assert main(["fly", str(plan), "--until", "plan", "-o", str(out), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["certificate"]["clean"]
    assert (out / "plan.json").read_bytes() == plan.read_bytes()
    assert "source: unknown" in (out / "scenario.yaml").read_text()
    assert "The terrain is not known." in (out / "report.html").read_text()
    assert {path.stem for path in (out / "figures").glob("*.png")} == {
        "throughput",
        "degree_energy",
    }


@pytest.mark.slow
def test_the_scenario_beside_a_plan_is_what_it_is_flown_under(tiny_run, tmp_path) -> None:
    """Its terrain, and all that a plan does not say."""
    out = tmp_path / "run"
    arguments = ["fly", str(tiny_run[0] / "plan.json"), "--until", "plan", "-o", str(out)]
    assert main(arguments) == 0
    assert "source: jacksboro" in (out / "scenario.yaml").read_text()
    assert (out / "figures" / "routes.png").exists()


def test_a_plan_for_another_fleet_than_the_scenarios_is_refused(plan, tiny, tmp_path, capsys):
    """Both fleets are named."""
    arguments = ["fly", str(plan), "--scenario", str(tiny), "-o", str(tmp_path / "run")]
    assert main([*arguments, "--set", 'fleet.ids=["a","b","c","d"]']) == 2
    assert "uav1, uav2, uav3, uav4" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--gates", "one"], "must be numbers of waypoints from 1 on"),
        (["--gates", "1,0"], "must be numbers of waypoints from 1 on"),
        (["--gates", "2@3"], "10 or more"),
        (["--gates", "2", "--set", "trajectory.mode=straight"], "are not those that vehicles keep"),
        (["--set", "trajectory.mode=straight"], "half a minute late and more. Plan for flight"),
        (["--vehicles", "sim:3"], "the fleet has 4 UAVs"),
        (["--vehicles", "udpin:127.0.0.1:14550"], "Give --arm, or look first with --until arm"),
        (["--scenario", "none.yaml"], "none.yaml"),
        (["--set", "fleet.cuont=3"], "Did you mean fleet.count"),
    ],
)
def test_what_cannot_be_flown_is_refused_before_anything_is_done(
    plan, tmp_path, capsys, options, words
) -> None:
    """Status 2, one sentence, no directory."""
    out = tmp_path / "run"
    assert main(["fly", str(plan), "-o", str(out), *options]) == 2
    assert words in capsys.readouterr().err
    assert not out.exists()


def test_a_missing_plan_is_said_to_be_missing(tmp_path, capsys) -> None:
    """Status 2, no traceback."""
    assert main(["fly", str(tmp_path / "none.json")]) == 2
    assert "none.json" in capsys.readouterr().err
