"""Two sorties of the short scene: planned together, flown in turn, what is left moved on."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from jfto_msgs_py.plan_file import read_plan
from support.domains import next_domain

ROOT = Path(__file__).parents[2]
pytestmark = pytest.mark.slow
SCENE = ROOT / "test" / "data" / "scenario" / "short_flight.yaml"
LIMIT_S = 900.0


def _fly(directory: Path, sortie: int) -> dict[str, Any]:
    environment = {
        **os.environ,
        "PYTHONPATH": str(ROOT / "src"),
        "ROS_DOMAIN_ID": str(next_domain()),
        "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST",
    }
    scene = [str(SCENE), "--set", "sorties.count=2", "-o", str(directory), "--json"]
    command = [sys.executable, "-m", "jfto", "run", *scene, "--sortie", str(sortie)]
    done = subprocess.run(
        [*command, "--speedup", "10"],
        env=environment,
        capture_output=True,
        text=True,
        timeout=LIMIT_S,
        check=False,
    )
    assert done.returncode == 0, done.stdout[-2000:] + done.stderr[-2000:]
    facts: dict[str, Any] = json.loads(done.stdout)
    return facts


def _visited(directory: Path) -> list[int]:
    passages = json.loads((directory / "flight.json").read_text())["waypoints"]["passages"]
    return [one["waypoint"] for one in passages if one["closest_m"] <= 2.0]


def test_sorties_are_flown_from_one_directory(tmp_path: Path) -> None:
    """Each visits its own waypoints and has its own record; a missed one goes to the next."""
    assert _fly(tmp_path, 1)["flight"]["good"]
    first, second = (read_plan(tmp_path / f"plan-{number}.json") for number in (1, 2))
    record = tmp_path / "sortie-1" / "flight.json"
    flown = json.loads(record.read_text())
    assert sorted(_visited(record.parent)) == [waypoint.id for waypoint in first.waypoints]
    # As if the first one had passed it by.
    missed = flown["waypoints"]["passages"][0]
    missed["closest_m"] = 9.0
    record.write_text(json.dumps(flown))
    assert _fly(tmp_path, 2)["flight"]["good"]
    wanted = {missed["waypoint"], *(waypoint.id for waypoint in second.waypoints)}
    assert set(_visited(tmp_path / "sortie-2")) == wanted
