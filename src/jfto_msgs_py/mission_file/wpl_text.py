"""QGC WPL text files (`.waypoints`): one line of twelve columns per item."""

from __future__ import annotations

import math
from collections.abc import Sequence

from jfto_msgs_py.mission_file.document import (
    FENCE_COMMANDS,
    RALLY,
    FileItem,
    MissionDocument,
    MissionTextError,
    whole,
)

HEADER = "QGC WPL 110"
# As 110, but without home in its first row.
HEADER_WITHOUT_HOME = "QGC WPL 120"
_COLUMNS = 12
_HOME_COMMANDS = (0, 16)


def parse_wpl_text(text: str, name: str) -> MissionDocument:
    """Items sorted into mission, fence and rally points by their commands.

    Raises MissionTextError, naming file and line.
    """
    # Only line ends end a line here: str.splitlines also breaks at characters inside a comment.
    lines = [line.strip() for line in text.replace("\r\n", "\n").replace("\r", "\n").split("\n")]
    header = " ".join(lines[0].split())
    if header not in (HEADER, HEADER_WITHOUT_HOME):
        raise MissionTextError(
            f'{name}: must begin with "{HEADER}", begins with {lines[0][:40]!r}. Save it as a '
            "mission file of Mission Planner or QGroundControl."
        )
    rows: list[FileItem] = []
    for number, line in enumerate(lines[1:], start=2):
        if line and not line.startswith("#") and line != "\x1a":
            rows.append(_row(line.split(), len(rows), f"{name} line {number}"))
    if header == HEADER_WITHOUT_HOME:
        home, items = None, rows
    else:
        home, items = _home(rows, name), rows[1:]
    return MissionDocument(
        tuple(item for item in items if item.command not in FENCE_COMMANDS | {RALLY}),
        home,
        tuple(item for item in items if item.command in FENCE_COMMANDS),
        tuple(item for item in items if item.command == RALLY),
    )


def _home(rows: Sequence[FileItem], name: str) -> tuple[float, float, float] | None:
    if not rows:
        return None
    first = rows[0]
    if first.command not in _HOME_COMMANDS or first.frame not in (0, 5):
        raise MissionTextError(
            f"{first.place}: the first row of {HEADER} is home, a waypoint (16) in frame 0, but "
            f"it is command {first.command} in frame {first.frame}. Put a row of home before it"
            f"{_count_again(rows)}."
        )
    lat, lon, height = first.params[4:]
    if not (abs(lat) <= 90 and abs(lon) <= 180):
        raise MissionTextError(f"{first.place}: home {lat}, {lon} is not on Earth. Correct {name}.")
    return lat, lon, height


def _count_again(rows: Sequence[FileItem]) -> str:
    return " and number the others anew" if len(rows) > 1 else ""


def _row(fields: Sequence[str], expected: int, place: str) -> FileItem:
    if len(fields) != _COLUMNS:
        raise MissionTextError(
            f"{place}: has {len(fields)} columns, needs {_COLUMNS}. Save the file again."
        )
    names = {0: "number", 1: "current", 2: "frame", 3: "command", 11: "autocontinue"}
    numbers = [
        _number(text, names.get(k, f"column {k + 1}"), place) for k, text in enumerate(fields)
    ]
    sequence, current, frame, command = (whole(numbers[k], names[k], place) for k in range(4))
    if sequence != expected:
        raise MissionTextError(
            f"{place}: item number {sequence}, expected {expected}. A line is missing, doubled or "
            "moved: save the file again, or number the items from 0."
        )
    # 1 in the first row only marks it as the file's home; vehicles ignore it.
    return FileItem(
        place,
        command,
        whole(frame, "frame", place, 0, 255),
        tuple(numbers[4:11]),
        whole(current, "current", place, 0, 255) if sequence else 0,
        whole(numbers[11], "autocontinue", place, 0, 255),
    )


def _number(text: str, what: str, place: str) -> float:
    try:
        # Python's own reading takes "1_000" for a thousand, and digits of all scripts.
        value = float(text) if text.isascii() and "_" not in text else math.inf
    except ValueError:
        value = math.inf
    if math.isinf(value) or abs(value) > 1e300:
        raise MissionTextError(
            f"{place}: {what} is {text[:40]!r}, must be a number with a decimal point. Correct it, "
            "or save the file again."
        )
    return value
