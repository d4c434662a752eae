"""Mission files that Mission Planner and QGroundControl open, told apart by their suffix; logs."""

from __future__ import annotations

from pathlib import Path

from jfto_mavlink.errors import MissionFileError
from jfto_mavlink.files.qgc_plan import read_qgc_plan, write_qgc_plan
from jfto_mavlink.files.wpl import read_wpl, write_wpl
from jfto_mavlink.protocol.item import Mission

WPL_SUFFIXES = (".waypoints", ".txt", ".wpl")


def read_mission(path: Path) -> Mission:
    """Read a `.plan` or `.waypoints` file; raises MissionFileError."""
    if path.suffix == ".plan":
        return read_qgc_plan(path)
    _need_wpl(path)
    return read_wpl(path)


def write_mission(path: Path, mission: Mission) -> tuple[Path, ...]:
    """Write a `.plan` or `.waypoints` file; returns the files written."""
    if path.suffix == ".plan":
        write_qgc_plan(path, mission)
        return (path,)
    _need_wpl(path)
    return write_wpl(path, mission)


def _need_wpl(path: Path) -> None:
    if path.suffix not in WPL_SUFFIXES:
        raise MissionFileError(302, f"{path}: name must end in .plan or .waypoints.")
