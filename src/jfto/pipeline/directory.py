"""The directory of one run: what lies in it and how it gets there."""

from __future__ import annotations

import dataclasses
import re
from datetime import datetime, timezone
from pathlib import Path
from typing import Any

import yaml

from jfto.planning.scenario_file import SHARED, LoadedScenario, names_a_file
from jfto.supervision.graph_table import (
    BAG_NAME,
    ENERGY_NAME,
    FLIGHT_STATE_NAME,
    GUIDED_NAMES,
    JOB_NAME,
    LIFT_OFF_NAME,
)
from jfto_msgs_py.errors import InputError
from jfto_msgs_py.files import write_file

PLAN_NAME = "plan.json"
INFEASIBLE_NAME = "plan.infeasible.json"
COVERAGE_NAME = "coverage.json"
FLIGHT_NAME = "flight.json"
REPORT_NAME = "report.html"
LOG_NAME = "log.txt"
FIGURES = "figures"
# What the nodes of a flight go on with after a restart.
_STATES = (LIFT_OFF_NAME, ENERGY_NAME, FLIGHT_STATE_NAME, *GUIDED_NAMES, JOB_NAME)
# A recorder that is started again goes on in bag-2, bag-3 and so on.
_BAG = re.compile(re.escape(BAG_NAME) + r"(?:-(\d+))?")


def make_run_directory(out: Path | None, kind: str = "run") -> Path:
    """Create the directory for a run: `out`, or `kind`-<UTC stamp>; raises InputError."""
    if out is None:
        stamp = datetime.now(timezone.utc).strftime("%Y%m%dT%H%M%SZ")
        out = Path(f"{kind}-{stamp}")
    if out.exists() and not out.is_dir():
        raise InputError(f"{out}: is a file. Name a directory with --out.")
    try:
        out.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(
            f"{out}: cannot be made: {error.strerror}. Name another place with --out."
        ) from None
    return out


def require_no_flight(directory: Path) -> None:
    """Refuse a directory that a flight was recorded in; raises InputError."""
    for name in (BAG_NAME, *_STATES):
        if (directory / name).exists():
            raise InputError(
                f"{directory}: holds a flight already ({name}). Name another directory with --out; "
                f"--plan {directory / PLAN_NAME} flies its plan again, and jfto run --resume "
                f"{directory} goes on with a flight that is under way."
            )


def forget_dry_run(directory: Path) -> None:
    """Remove what nodes remember, after a run in which nothing started: no flight goes on there."""
    for name in _STATES:
        (directory / name).unlink(missing_ok=True)


def flight_bags(directory: Path) -> list[Path]:
    """Bags of a run in the order in which they were begun; empty where nothing was recorded."""
    found = [(_BAG.fullmatch(path.name), path) for path in directory.iterdir() if path.is_dir()]
    return [path for _, path in sorted((int(name[1] or 1), path) for name, path in found if name)]


def what_is_kept(directory: Path) -> str:
    """What an interrupted run leaves, and how to go on from there."""
    for name, words in ((PLAN_NAME, "The best plan so far"), (INFEASIBLE_NAME, "The closest plan")):
        if (directory / name).exists():
            return (
                f"{words} is kept: {directory / name}. "
                f"Finish the report with: jfto report {directory}"
            )
    return f"There was no plan yet; {directory} holds the scenario only."


def write_scenario(loaded: LoadedScenario, path: Path) -> str:
    """Write the resolved scenario, files named by absolute paths, so that it stands alone.

    Returns what was written.
    """
    scenario = loaded.scenario
    terrain, waypoints = scenario.terrain, scenario.waypoints
    area, fence = scenario.area, scenario.fence
    source, surface = (
        str(loaded.resolve(named).resolve()) if named and names_a_file(named) else named
        for named in (terrain.source, terrain.surface)
    )
    terrain = dataclasses.replace(terrain, source=source, surface=surface)
    if waypoints.file:
        waypoints = dataclasses.replace(
            waypoints, file=str(loaded.resolve(waypoints.file).resolve())
        )
    if fence.file:
        fence = dataclasses.replace(fence, file=str(loaded.resolve(fence.file).resolve()))
    if area.file:
        area = dataclasses.replace(area, file=str(loaded.resolve(area.file).resolve()))
    changed = dataclasses.replace(
        scenario, terrain=terrain, waypoints=waypoints, area=area, fence=fence
    )
    values = changed.values()
    nested: dict[str, dict[str, Any]] = {}
    for name, value in values.items():
        part, key = name.split(".", 1)
        # ROS parameter files have no empty lists: a key that is left out has its default.
        if value != ():
            nested.setdefault(part, {})[key] = list(value) if isinstance(value, tuple) else value
    text = f"# Resolved from {loaded.path.name}: every key, no default left out.\n"
    text += yaml.safe_dump({SHARED: {"ros__parameters": nested}}, sort_keys=False, width=100)
    write_file(path, text)
    return text
