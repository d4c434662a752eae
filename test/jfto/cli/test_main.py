"""The command line as a user meets it."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from pathlib import Path

import pytest

from jfto.cli import main
from jfto.cli.main import COMMANDS
from jfto.pipeline.run import Run

HEAVY = (
    "numpy",
    "scipy",
    "numba",
    "torch",
    "matplotlib",
    "rasterio",
    "pyogrio",
    "shapely",
    "yaml",
    "rich",
    "plotly",
)
ROOT = Path(__file__).parents[3]


@pytest.mark.slow
@pytest.mark.parametrize("arguments", [[], *([name] for name in COMMANDS)])
def test_help_loads_nothing_heavy(arguments: list[str]) -> None:
    """`jfto --help` and each command's help import no numerical or drawing library."""
    program = (
        "import sys; from jfto.cli import main\n"
        f"status = main({[*arguments, '--help']!r})\n"
        f"loaded = [name for name in {HEAVY!r} if name in sys.modules]\n"
        "print('LOADED', loaded); sys.exit(status)"
    )
    done = subprocess.run(
        [sys.executable, "-c", program],
        capture_output=True,
        text=True,
        env={"PYTHONPATH": str(ROOT / "src"), "PATH": ""},
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert "LOADED []" in done.stdout
    assert "Usage: jfto" in done.stdout


def test_plan_and_check_agree(
    tiny: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """What `jfto plan` writes, `jfto check` verifies, and both say the same to a program."""
    path = tmp_path / "plan.json"
    assert main(["plan", str(tiny), "-o", str(path), "--json"]) == 0
    planned = json.loads(capsys.readouterr().out)
    assert main(["check", str(path), "--json"]) == 0
    checked = json.loads(capsys.readouterr().out)
    assert planned["certificate"] == checked["certificate"]
    assert planned["length_m"] == checked["length_m"]
    assert main(["check", str(path)]) == 0
    assert "verified" in capsys.readouterr().out


def test_check_looks_at_the_ground_below(
    tiny_run: tuple[Path, Run], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Routes and ways home over the scenario's terrain; where there is none, why is said."""
    plan, scenario = tiny_run[0] / "plan.json", tiny_run[0] / "scenario.yaml"
    assert main(["check", str(plan)]) == 0
    assert "routes and ways home checked over jacksboro" in capsys.readouterr().out
    alone = tmp_path / "plan.json"
    alone.write_bytes(plan.read_bytes())
    assert main(["check", str(alone)]) == 0
    assert "not checked: no scenario.yaml beside the plan" in capsys.readouterr().out
    high = tmp_path / "high.yaml"
    text, count = re.subn(r"(clearance_m: )[\d.]+", r"\g<1>90.0", scenario.read_text())
    assert count == 1
    high.write_text(text)
    assert main(["check", str(alone), "--scenario", str(high), "--json"]) == 3
    found = json.loads(capsys.readouterr().out)
    wanted = found["certificate"]["violations"]
    assert any("on its way home, 90 m are wanted" in message for message in wanted)
    high.rename(tmp_path / "scenario.yaml")
    assert main(["check", str(alone)]) == 0
    assert "scenario.yaml is not the scenario of this plan" in capsys.readouterr().out


def test_a_learned_plan_is_told_beside_the_search(
    tiny: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """--method rl+search says what the search alone found, to programs too."""
    path = tmp_path / "plan.json"
    assert main(["plan", str(tiny), "-o", str(path), "--json", "--method", "rl+search"]) == 0
    learned = json.loads(capsys.readouterr().out)["learned"]
    assert learned.startswith("rl+search 1.")
    assert "search alone 1." in learned


def test_a_broken_plan_is_found_out(
    tiny_run: tuple[Path, Run], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A plan whose UAV flies elsewhere than its route fails `jfto check` with status 3."""
    plan = json.loads((tiny_run[0] / "plan.json").read_text())
    plan["positions_m"][1][5] = plan["positions_m"][0][5]
    path = tmp_path / "plan.json"
    path.write_text(json.dumps(plan))
    assert main(["check", str(path)]) == 3
    said = capsys.readouterr().out
    assert "not feasible" in said
    assert "✗" in said


@pytest.mark.slow
def test_an_impossible_wish_is_an_answer(
    tiny: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Too little energy ends with status 3, the closest plan kept, violations and cures said."""
    path = tmp_path / "plan.json"
    status = main(["plan", str(tiny), "-o", str(path), "--set", "fleet.energy_j=0.001"])
    said = capsys.readouterr().err
    assert status == 3
    assert not path.exists()
    kept = json.loads((tmp_path / "plan.infeasible.json").read_text())
    assert kept["certificate"]["violations"]
    assert "Infeasible: " in said
    assert "would help: " in said
    assert "dB antenna gain" in said
    assert "plan.infeasible.json" in said


@pytest.mark.slow
def test_evaluate_takes_a_plan_and_writes_files(
    tiny_run: tuple[Path, Run], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """`jfto evaluate plan.json` prints the table and writes CSV, JSON and figures."""
    directory, _ = tiny_run
    out = tmp_path / "comparison"
    assert main(["evaluate", str(directory / "plan.json"), "-o", str(out)]) == 0
    said = capsys.readouterr().out
    assert "C-TOP" in said
    assert "(97.2)" in said
    assert (out / "comparison.csv").exists()
    assert (out / "small" / "topology.png").exists()


@pytest.mark.slow
def test_coverage_writes_waypoints_that_a_scenario_can_read(
    tiny: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Waypoints exported as CSV or GeoJSON come back the same through waypoints.file."""
    for name in ("waypoints.csv", "waypoints.geojson"):
        path = tmp_path / name
        computed = ["--set", "waypoints.source=coverage"]
        assert main(["coverage", str(tiny), *computed, "-o", str(path), "--json"]) == 0
        there = json.loads(capsys.readouterr().out)
        reading = ["--set", "waypoints.source=file", "--set", f"waypoints.file={path}"]
        assert main(["coverage", str(tiny), *reading, "--json"]) == 0
        back = json.loads(capsys.readouterr().out)
        assert there["waypoints"] == back["waypoints"] > 20
        assert there["seen_once"] >= 0.99


def test_doctor_finds_this_environment_sound(capsys: pytest.CaptureFixture[str]) -> None:
    """Where the tests run, nothing that planning needs is missing."""
    assert main(["doctor", "--json"]) == 0
    findings = json.loads(capsys.readouterr().out)["findings"]
    assert {finding["name"] for finding in findings} >= {"Python", "numpy", "terrain", "ROS 2"}


def test_errors_are_json_for_programs(tiny: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """With --json an error too is one JSON object, with its status and every problem."""
    assert main(["plan", str(tiny), "--json", "--set", "network.k_min=9"]) == 2
    said = json.loads(capsys.readouterr().out)
    assert said["exit_status"] == 2
    assert "network.k_min" in said["problems"][0]


def test_debug_shows_where_an_error_came_from(tiny: Path) -> None:
    """--debug raises instead of summarising, for whoever has to find the cause."""
    from jfto_msgs_py.errors import ScenarioError

    with pytest.raises(ScenarioError):
        main(["plan", str(tiny), "--debug", "--set", "network.k_min=9"])
