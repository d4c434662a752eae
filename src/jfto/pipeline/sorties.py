"""Files of several sorties: plans by number, a run directory each, and what flights left undone."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Sequence
from pathlib import Path

from jfto.pipeline.directory import FLIGHT_NAME, PLAN_NAME
from jfto_msgs_py.errors import InputError, PlanError
from jfto_msgs_py.files import read_text, write_files
from jfto_msgs_py.plan_file import plan_text, read_plan
from jfto_msgs_py.records.passage import VISITED_M
from jfto_msgs_py.records.plan import Plan, Waypoint

_SIZE_LIMIT = 500_000_000


def sortie_file(path: Path, number: int) -> Path:
    """Where the plan of a sortie lies when `path` is asked for: plan-2.json for plan.json."""
    return path.with_name(f"{path.stem}-{number}{path.suffix}")


def sortie_directory(directory: Path, number: int) -> Path:
    """Where a sortie of the run in `directory` is flown, recorded and reported."""
    return directory / f"sortie-{number}"


def save_sorties(plans: tuple[Plan, ...], path: Path) -> tuple[Path, ...]:
    """Write clean plans beside `path`, all or none, as `sortie_file` names them; returns where.

    Plans of an earlier division into more sorties are removed (`stale_sorties`). Raises InputError.
    """
    stale = stale_sorties(path, plans)
    files = [sortie_file(path, number) for number in range(1, len(plans) + 1)]
    write_files({file: plan_text(plan) for file, plan in zip(files, plans, strict=True)})
    for file in stale:
        file.unlink()
    return tuple(files)


def stale_sorties(path: Path, plans: Sequence[Plan]) -> tuple[Path, ...]:
    """Plans of an earlier division that `plans` beside `path` make void: of sorties with greater
    numbers, or of any where there is one plan now, about the same origin.

    What is no plan of the sortie of its name, or of another place, is somebody else's.
    """
    beyond = len(plans) if len(plans) > 1 else 0
    pattern = re.compile(re.escape(path.stem) + r"-(\d+)" + re.escape(path.suffix))
    stale = []
    for file in sorted(path.parent.glob(f"{path.stem}-*{path.suffix}")):
        found = pattern.fullmatch(file.name)
        if found is None or int(found[1]) <= beyond:
            continue
        try:
            earlier = read_plan(file)
        except PlanError:
            continue
        sortie, here = earlier.sortie, plans[0].origin
        place = (earlier.origin.lat_deg, earlier.origin.lon_deg) == (here.lat_deg, here.lon_deg)
        if sortie.count > 1 and sortie.number == int(found[1]) and place:
            stale.append(file)
    return tuple(stale)


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
