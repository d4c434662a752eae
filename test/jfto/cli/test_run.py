"""jfto run: what it refuses before anything is done."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest

from jfto.cli import main
from jfto_mavlink.preflight.page import read_page
from support.domains import next_domain


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--vehicles", "udpin:127.0.0.1:14550"], "Give --arm, or look first with --until arm"),
        (["--vehicles", "sim:3"], "the fleet has 4 UAVs"),
        (["--vehicles", "uav1=1@udpin:127.0.0.1:14550", "--arm"], "uav2"),
        (["--vehicles", "roster", "--arm"], "names no roster and no endpoints"),
        (["--vehicles", "tcp:127.0.0.1:5760", "--arm", "--speedup", "5"], "real ones keep time"),
        (["--vehicles", "sim", "--key", "some.key"], "leave --key out"),
    ],
)
def test_what_cannot_be_flown_is_refused_before_anything_is_done(
    tiny, tmp_path, capsys, options, words
) -> None:
    """Status 2, one sentence, no directory."""
    out = tmp_path / "run"
    assert main(["run", str(tiny), "-o", str(out), *options]) == 2
    assert words in capsys.readouterr().err
    assert not out.exists()


@pytest.mark.parametrize("name", ["bag", "energy.json", "lift_off.json", "flight_state.json"])
def test_a_flight_is_not_mixed_with_an_earlier_one(tiny, tmp_path, capsys, name) -> None:
    """A bag, an account or a lift-off of before would be gone on with; the cure names the plan."""
    (tmp_path / name).touch()
    assert main(["run", str(tiny), "-o", str(tmp_path)]) == 2
    said = capsys.readouterr().err
    assert f"holds a flight already ({name})" in said
    assert f"--plan {tmp_path}/plan.json" in said


def test_a_plan_for_another_fleet_is_refused(tiny, tiny_run, tmp_path, capsys) -> None:
    """Before the graph starts, with both fleets named."""
    directory, _ = tiny_run
    arguments = ["run", str(tiny), "--plan", str(directory / "plan.json"), "-o", str(tmp_path)]
    assert main([*arguments, "--set", 'fleet.ids=["a","b","c","d"]']) == 2
    assert "uav1, uav2, uav3, uav4" in capsys.readouterr().err
    assert not (tmp_path / "bag").exists()


@pytest.mark.slow
def test_a_dry_run_shows_the_checks_and_draws_nothing(tiny, tmp_path) -> None:
    """Missions on board, the page on the screen and on disk; no comparison, figures or report."""
    command = [sys.executable, "-m", "jfto", "run", str(tiny), "--until", "arm"]
    ended = subprocess.run(
        [*command, "-o", str(tmp_path), "--set", "trajectory.mode=waypoints"],
        env={**os.environ, "ROS_DOMAIN_ID": str(next_domain())},
        capture_output=True,
        text=True,
        timeout=500,
        check=False,
    )
    assert ended.returncode == 0, ended.stderr
    assert "Preflight: nothing speaks against a start" in ended.stderr
    assert "uav4" in ended.stderr
    names = {path.name for path in tmp_path.iterdir()}
    assert not names & {"figures", "report.html", "comparison.json"}
    assert read_page(tmp_path / "preflight.json").stops() == ()
    assert "parameters.json" not in names
