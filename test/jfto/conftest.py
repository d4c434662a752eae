"""A tiny scene, planned once for all tests of the front."""

from __future__ import annotations

from pathlib import Path

import pytest

from jfto.pipeline.directory import make_run_directory
from jfto.pipeline.run import Run
from jfto.planning.routes import plan_routes
from jfto.planning.scenario_file import load_scenario
from jfto.planning.survey import Survey, survey
from jfto_msgs_py.records.plan import Plan
from support.runs import run_all

TINY = Path(__file__).parents[1] / "data" / "scenario" / "tiny.yaml"


@pytest.fixture(scope="session")
def tiny() -> Path:
    """Scenario file that is planned in a second."""
    return TINY


@pytest.fixture(scope="session")
def tiny_run(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Run]:
    """Directory and outcome of a full run of the tiny scene."""
    directory = make_run_directory(tmp_path_factory.mktemp("run") / "tiny")
    return directory, run_all(load_scenario(TINY), directory)


@pytest.fixture(scope="session")
def tiny_survey() -> Survey:
    """Terrain and waypoints of the tiny scene."""
    return survey(load_scenario(TINY))


@pytest.fixture(scope="session")
def tiny_guided(tiny_survey: Survey) -> Plan:
    """Plan of the tiny scene for guided flight."""
    scenario = load_scenario(TINY, ["trajectory.mode=guided"]).scenario
    return plan_routes(scenario, tiny_survey).plan
