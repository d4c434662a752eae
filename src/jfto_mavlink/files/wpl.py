"""Writes QGC WPL 110 text files (`.waypoints`): one list of items per file.

Mission Planner keeps fence and rally points in files of their own, each with home as its first
row; so does this module, beside the mission: `x.waypoints`, `x.fence.waypoints`,
`x.rally.waypoints`.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from jfto_mavlink.dialect import mavlink
from jfto_mavlink.errors import MissionFileError
from jfto_mavlink.protocol.item import FRAME_ABSOLUTE, Item, Mission
from jfto_msgs_py.mission_file.wpl_text import HEADER


def write_wpl(path: Path, mission: Mission) -> tuple[Path, ...]:
    """Write a mission, and its fence and rally points beside it; returns the files written.

    Raises MissionFileError where a file beside it would add to the mission when it is read.
    """
    home = mission.items[:1] or (Item(mavlink.MAV_CMD_NAV_WAYPOINT, FRAME_ABSOLUTE),)
    written = []
    for target, items in (
        # A header alone would be taken for a file that was cut short.
        (path, mission.items or home),
        (_beside(path, "fence"), (*home, *mission.fence) if mission.fence else ()),
        (_beside(path, "rally"), (*home, *mission.rally) if mission.rally else ()),
    ):
        if target != path and not items and target.exists():
            raise MissionFileError(
                302,
                f"{target}: lies there from an earlier mission and would be read with "
                f"{path.name}, which has none of it. Remove it, or write elsewhere.",
            )
        if items or target == path:
            target.write_text(wpl_text(items), encoding="ascii")
            written.append(target)
    return tuple(written)


def wpl_text(items: Sequence[Item]) -> str:
    """The file's text: tab-separated columns, numbers in full precision."""
    lines = [HEADER]
    for seq, item in enumerate(items):
        x, y = (
            (f"{item.lat_deg:.8f}", f"{item.lon_deg:.8f}")
            if item.has_position
            else (str(item.x), str(item.y))
        )
        fields = [
            str(seq),
            str(item.current if seq or item.current else 1),
            str(item.frame),
            str(item.command),
            *(_number(p) for p in item.params),
            x,
            y,
            _number(item.z),
            str(item.autocontinue),
        ]
        lines.append("\t".join(fields))
    return "\n".join(lines) + "\n"


def _number(value: float) -> str:
    """Shortest decimal text that gives back the same 32-bit float."""
    return np.format_float_positional(np.float32(value), unique=True, trim="0")


def _beside(path: Path, name: str) -> Path:
    return path.with_name(f"{path.stem}.{name}{path.suffix}")
