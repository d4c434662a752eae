"""Mission files that Mission Planner and QGroundControl open, told apart by their suffix; logs."""

from __future__ import annotations

from pathlib import Path

from jfto_mavlink.errors import MissionFileError
from jfto_mavlink.files.mission_of_document import mission_of_document
from jfto_mavlink.files.qgc_plan import write_qgc_plan
from jfto_mavlink.files.wpl import write_wpl
from jfto_mavlink.protocol.item import Mission
from jfto_msgs_py.mission_file import PLAN_SUFFIX, WPL_SUFFIXES, MissionTextError, read_document


def read_mission(path: Path) -> Mission:
    """Read a `.plan` or `.waypoints` file; raises MissionFileError.

    `notes` of the mission name what the file holds and the mission does not.
    """
    try:
        return mission_of_document(read_document(path), str(path))
    except MissionTextError as error:
        raise MissionFileError(302, str(error)) from None


def write_mission(path: Path, mission: Mission) -> tuple[Path, ...]:
    """Write a `.plan` or `.waypoints` file; returns the files written. Raises MissionFileError."""
    suffix = path.suffix.lower()
    try:
        if suffix == PLAN_SUFFIX:
            write_qgc_plan(path, mission)
            return (path,)
        if suffix in WPL_SUFFIXES:
            return write_wpl(path, mission)
    except OSError as error:
        raise MissionFileError(
            302, f"{path}: cannot be written: {error.strerror}. Name another place."
        ) from None
    raise MissionFileError(302, f"{path}: name must end in .plan or .waypoints. Name it so.")
