"""A fleet of one: planned, compared and reported without links."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from jfto.cli.main import main
from jfto.pipeline.run import Run
from jfto.planning.scenario_file import load_scenario
from jfto_mavlink.mission.build import build_missions
from jfto_mavlink.mission.settings import settings_for
from support.html import HtmlChecker
from support.runs import run_all

SCENE = Path(__file__).parents[2] / "data" / "scenario" / "alone.yaml"
NAV_LAND = 21


@pytest.fixture(name="alone", scope="module")
def _alone(tmp_path_factory: pytest.TempPathFactory) -> Run:
    return run_all(load_scenario(SCENE), tmp_path_factory.mktemp("alone"))


def test_one_uav_plans_and_comes_home(alone: Run) -> None:
    """Clean, with a way home, and no least distance to anybody."""
    assert alone.plan.clean
    assert alone.plan.landed_s is not None
    assert alone.plan.landed_s > alone.plan.slots.horizon_s
    (mission,) = build_missions(alone.plan, settings_for(alone.plan))
    assert mission.mission.items[-1].command == NAV_LAND


def test_its_report_says_that_there_is_no_neighbour(alone: Run) -> None:
    """No figure of links, no infinite metres, nothing that is not a number."""
    assert alone.report is not None
    page = alone.report.read_text(encoding="utf-8")
    checker = HtmlChecker()
    checker.feed(page)
    assert (checker.open, checker.amiss, checker.outside) == ([], [], [])
    shown = re.sub(r"<(script|style)>.*?</\1>|<[^>]*>", " ", page, flags=re.DOTALL)
    assert not re.search(r"\b(inf|nan|NaN|Infinity)\b", shown)
    assert "no neighbour, fleet of one" in shown
    drawn = {path.stem for path in (alone.report.parent / "figures").glob("*.png")}
    assert drawn == {"routes", "flight"}


@pytest.mark.parametrize("command", ["check", "evaluate"])
def test_commands_take_it(alone: Run, capsys: pytest.CaptureFixture[str], command: str) -> None:
    """Their words have neither infinite metres nor empty sentences."""
    assert main([command, str(alone.plan_path)]) == 0
    said = capsys.readouterr().out
    assert not re.search(r"\b(inf|nan)\b", said)
    assert "throughput is \n" not in said


def test_its_error_names_a_cure_that_is_allowed(capsys: pytest.CaptureFixture[str]) -> None:
    """K_min 0 is what a fleet of one takes."""
    assert main(["plan", str(SCENE), "--set", "network.k_min=1"]) == 2
    assert "1 UAV can have at most 0 neighbours. Set it to 0, or" in capsys.readouterr().err


def test_a_battery_that_does_not_last_is_infeasible(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The flight time with the way home counts, and the message says by how much it is over."""
    wanted = ["--set", "fleet.endurance_s=60", "-o", str(tmp_path / "plan.json")]
    assert main(["plan", str(SCENE), *wanted]) == 3
    assert "its battery lasts 60 s" in capsys.readouterr().err
    wanted[1] = "fleet.endurance_s=900"
    assert main(["plan", str(SCENE), *wanted]) == 0
    assert main(["check", str(tmp_path / "plan.json")]) == 0
    assert "of 900 s left on landing (uav1, the tightest)" in capsys.readouterr().out
