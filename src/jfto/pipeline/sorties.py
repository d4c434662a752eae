"""Several sorties in one place: plan files by number, one run directory each, what one leaves."""

from __future__ import annotations

import json
import math
import re
from dataclasses import replace
from pathlib import Path

import numpy as np

from jfto.console.progress import SILENT, Progress
from jfto.pipeline.directory import FLIGHT_NAME, PLAN_NAME
from jfto.pipeline.run import Pipeline, Run
from jfto.planning.routes import plan_routes
from jfto.planning.scenario_file import LoadedScenario
from jfto.planning.survey import Survey
from jfto.planning.terrain import load_ground
from jfto_msgs_py.errors import InfeasibleError, InputError, PlanError
from jfto_msgs_py.files import read_text, write_files
from jfto_msgs_py.plan_file import plan_text, read_plan
from jfto_msgs_py.records.passage import VISITED_M
from jfto_msgs_py.records.plan import Plan, Waypoint
from jfto_msgs_py.records.site import Sortie

_SIZE_LIMIT = 500_000_000


def sortie_file(path: Path, number: int) -> Path:
    """Where the plan of a sortie lies when `path` is asked for: plan-2.json for plan.json."""
    return path.with_name(f"{path.stem}-{number}{path.suffix}")


def sortie_directory(directory: Path, number: int) -> Path:
    """Where a sortie of the run in `directory` is flown, recorded and reported."""
    return directory / f"sortie-{number}"


def save_sorties(plans: tuple[Plan, ...], path: Path) -> tuple[Path, ...]:
    """Write clean plans beside `path`, all or none, as `sortie_file` names them; returns where.

    Plans of an earlier division into more sorties are removed. Raises InputError.
    """
    files = [sortie_file(path, number) for number in range(1, len(plans) + 1)]
    write_files({file: plan_text(plan) for file, plan in zip(files, plans, strict=True)})
    forget_sorties(path, beyond=len(plans))
    return tuple(files)


def forget_sorties(path: Path, beyond: int = 0) -> None:
    """Remove plans of sorties with greater numbers that lie beside `path`; what is no plan of the
    sortie of its name is somebody else's and stays.
    """
    pattern = re.compile(re.escape(path.stem) + r"-(\d+)" + re.escape(path.suffix))
    for file in path.parent.glob(f"{path.stem}-*{path.suffix}") if path.parent.exists() else ():
        found = pattern.fullmatch(file.name)
        if found is None or int(found[1]) <= beyond:
            continue
        try:
            sortie = read_plan(file).sortie
        except PlanError:
            continue
        if sortie.count > 1 and sortie.number == int(found[1]):
            file.unlink()


def left_over(directory: Path, number: int) -> dict[int, tuple[Waypoint, ...]]:
    """Waypoints that sorties before `number` were to visit and none did, by the sortie's number.

    Sorties that nobody has flown, as far as the directory knows, leave nothing. Raises InputError.
    """
    due: dict[int, tuple[Waypoint, ...]] = {}
    visited: set[int] = set()
    for earlier in range(1, number):
        folder = sortie_directory(directory, earlier)
        if (folder / FLIGHT_NAME).exists():
            visited |= _visited(folder / FLIGHT_NAME)
            due[earlier] = read_plan(folder / PLAN_NAME).waypoints
    left: dict[int, tuple[Waypoint, ...]] = {}
    known: set[int] = set()
    for earlier, waypoints in due.items():
        mine = tuple(w for w in waypoints if w.photo and w.id not in visited | known)
        known |= {waypoint.id for waypoint in mine}
        if mine:
            left[earlier] = mine
    return left


def with_left_over(
    loaded: LoadedScenario,
    directory: Path,
    plans: tuple[Plan, ...],
    number: int,
    progress: Progress = SILENT,
) -> Plan:
    """The plan of a sortie, made anew with what earlier ones left where there is such.

    One sortie more than there are plans takes what all of them left. Where not all of it fits, the
    plan stays as it is and the rest waits; both are told. Raises InfeasibleError, InputError.
    """
    left, more = left_over(directory, number), number > len(plans)
    waypoints = tuple(waypoint for some in left.values() for waypoint in some)
    if number > len(plans) + 1 or (more and not waypoints):
        raise InputError(
            f"--sortie {number}: there {'are' if len(plans) > 1 else 'is'} {len(plans)}"
            f"{'' if number > len(plans) + 1 else ', and none has left a waypoint'}. "
            f"Give 1 to {len(plans)}."
        )
    sortie = Sortie(number, max(number, len(plans)))
    own = None if more else plans[number - 1]
    if not waypoints and own is not None:
        return replace(own, sortie=sortie)
    said = f"{_counted(len(waypoints))} left by sortie {' and '.join(map(str, left))}"
    like = own or plans[-1]
    pads = np.array([uav.start_m[:2] for uav in like.uavs])
    before = () if own is None else tuple(w for w in own.waypoints if w.photo)
    found = Survey(load_ground(loaded), before + waypoints, None, starts_m=pads)
    try:
        planned = plan_routes(loaded.scenario, found, progress)
    except InfeasibleError:
        if own is None:
            raise
        planned = None
    if planned is not None and planned.interrupted:
        raise KeyboardInterrupt
    if own is not None and (planned is None or not planned.plan.clean):
        progress.warn(f"{said} did not fit into this sortie, wait for --sortie {number + 1}.")
        return replace(own, sortie=sortie)
    assert planned is not None
    progress.end("left over", f"{len(waypoints)} waypoints", f"{said} added")
    return replace(planned.plan, sortie=sortie)


def sortie_run(
    loaded: LoadedScenario, directory: Path, planned: Run, number: int, progress: Progress = SILENT
) -> tuple[Pipeline, Run]:
    """The run of one sortie, in a directory of its own below that of the whole one.

    Its plan has what earlier sorties left. Raises InputError where there is no such sortie.
    """
    plans = tuple(read_plan(file) for file in planned.sorties) or (planned.plan,)
    plan = with_left_over(loaded, directory, plans, number, progress)
    pipeline = Pipeline(loaded, sortie_directory(directory, number), progress)
    return pipeline, pipeline.keep(plan)


def report_others(
    loaded: LoadedScenario, directory: Path, planned: Run, number: int, progress: Progress = SILENT
) -> None:
    """Figures and report of every sortie but one, as planned."""
    for other in range(1, len(planned.sorties) + 1):
        if other != number:
            pipeline, run = sortie_run(loaded, directory, planned, other, progress)
            pipeline.report(run)


def _counted(waypoints: int) -> str:
    return f"{waypoints} waypoint{'s' * (waypoints > 1)}"


def _visited(path: Path) -> set[int]:
    """Waypoints that a flight on record has visited; raises InputError."""
    try:
        passages = json.loads(read_text(path, InputError, "flight", _SIZE_LIMIT))["waypoints"][
            "passages"
        ]
        near = {each["waypoint"]: each["closest_m"] for each in passages}
    except (ValueError, KeyError, TypeError):
        raise InputError(
            f"{path}: is not the record of a flight. Make it anew with jfto report {path.parent}."
        ) from None
    return {
        number
        for number, metres in near.items()
        if (math.inf if metres is None else metres) <= VISITED_M
    }
