"""QGC WPL 110 text files (`.waypoints`): one list of items per file.

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
from jfto_mavlink.mission.fence import FENCE_COMMANDS, RALLY_COMMAND
from jfto_mavlink.protocol.item import DEGREE_1E7, FRAME_ABSOLUTE, Item, Mission

HEADER = "QGC WPL 110"
COLUMNS = 12


def write_wpl(path: Path, mission: Mission) -> tuple[Path, ...]:
    """Write a mission, and its fence and rally points beside it; returns the files written."""
    home = mission.items[:1] or (Item(mavlink.MAV_CMD_NAV_WAYPOINT, FRAME_ABSOLUTE),)
    written = []
    for target, items in (
        (path, mission.items),
        (_beside(path, "fence"), (*home, *mission.fence) if mission.fence else ()),
        (_beside(path, "rally"), (*home, *mission.rally) if mission.rally else ()),
    ):
        if items or target == path:
            target.write_text(wpl_text(items), encoding="ascii")
            written.append(target)
    return tuple(written)


def read_wpl(path: Path) -> Mission:
    """Read a mission and, where they lie beside it, its fence and rally points."""
    parts = [parse_wpl(path.read_text(encoding="utf-8-sig"), str(path))] if path.exists() else None
    if parts is None:
        raise MissionFileError(302, f"{path}: no such file.")
    for name in ("fence", "rally"):
        beside = _beside(path, name)
        if beside.exists():
            parts.append(parse_wpl(beside.read_text(encoding="utf-8-sig"), str(beside)))
    items, fence, rally = (
        tuple(item for part in parts for item in getattr(part, name))
        for name in ("items", "fence", "rally")
    )
    return Mission(items, fence, rally)


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


def parse_wpl(text: str, name: str) -> Mission:
    """Items of a file's text, sorted into mission, fence and rally by their commands."""
    lines = [line.strip() for line in text.splitlines()]
    if not lines or lines[0] != HEADER:
        raise MissionFileError(302, f'{name}: must begin with "{HEADER}".')
    items: list[Item] = []
    for number, line in enumerate(lines[1:], start=2):
        if not line or line.startswith("#"):
            continue
        fields = line.split()
        if len(fields) != COLUMNS:
            raise MissionFileError(
                302, f"{name} line {number}: has {len(fields)} columns, needs {COLUMNS}."
            )
        try:
            items.append(_item(fields, len(items)))
        except ValueError as error:
            raise MissionFileError(302, f"{name} line {number}: {error}.") from error
    fence = tuple(item for item in items if item.command in FENCE_COMMANDS)
    rally = tuple(item for item in items if item.command == RALLY_COMMAND)
    if fence or rally:
        # The first row of a fence or rally file is home.
        return Mission((), fence, rally)
    return Mission(tuple(items))


def _item(fields: Sequence[str], expected_seq: int) -> Item:
    seq, current, frame, command = (int(text) for text in fields[:4])
    if seq != expected_seq:
        raise ValueError(f"item number {seq}, expected {expected_seq}")
    p1, p2, p3, p4, x, y, z = (float(text) for text in fields[4:11])
    plain = Item(command, frame)
    scale = DEGREE_1E7 if plain.has_position else 1
    # 1 in the first row only marks it as the file's home; vehicles ignore it.
    return Item(
        command,
        frame,
        (p1, p2, p3, p4),
        round(x * scale),
        round(y * scale),
        z,
        current if seq else 0,
        int(fields[11]),
    )


def _number(value: float) -> str:
    """Shortest decimal text that gives back the same 32-bit float."""
    return np.format_float_positional(np.float32(value), unique=True, trim="0")


def _beside(path: Path, name: str) -> Path:
    return path.with_name(f"{path.stem}.{name}{path.suffix}")
