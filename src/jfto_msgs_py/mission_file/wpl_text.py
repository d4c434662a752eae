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
from jfto_msgs_py.mission_file.jumps import with_jumps

HEADER = "QGC WPL 110"
# As 110, but without home in its first row.
HEADER_WITHOUT_HOME = "QGC WPL 120"
_COLUMNS = 12
_HOME_COMMANDS, _TAKEOFF = (0, 16), 22


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
    has_home = header == HEADER
    rows: list[FileItem] = []
    home_m = 0.0
    for number, line in enumerate(lines[1:], start=2):
        if line and not line.startswith("#") and line != "\x1a":
            fields, place = line.split(), f"{name} line {number}"
            if has_home and not rows:
                home_m, fields = _home_height_m(fields, place)
            rows.append(_row(fields, len(rows), place))
    if not rows:
        raise MissionTextError(
            f"{name}: holds its first line and nothing else. It was cut short or saved empty: save "
            "it again."
        )
    home = (*_home(rows, name)[:2], home_m) if has_home else None
    if not has_home:
        _require_no_home(rows)
    numbered = [(k, item) for k, item in enumerate(rows) if k or not has_home]
    items = [item for _, item in numbered]
    kept = [(k, item) for k, item in numbered if item.command not in FENCE_COMMANDS | {RALLY}]
    return MissionDocument(
        with_jumps([item for _, item in kept], [k for k, _ in kept]),
        home,
        tuple(item for item in items if item.command in FENCE_COMMANDS),
        tuple(item for item in items if item.command == RALLY),
    )


def _home_height_m(fields: list[str], place: str) -> tuple[float, list[str]]:
    """Height of home, NaN where it is left open as a `.plan` may, and its row with a number."""
    if len(fields) != _COLUMNS:
        return 0.0, fields
    height_m = _number(fields[10], "column 11", place)
    return height_m, [*fields[:10], "0", fields[11]] if math.isnan(height_m) else fields


def _require_no_home(rows: Sequence[FileItem]) -> None:
    """Refuse a waypoint above sea level before the take-off: it is home, which has no row here."""
    first = rows[0]
    if first.command not in _HOME_COMMANDS or first.frame not in (0, 5):
        return
    if any(item.command == _TAKEOFF for item in rows):
        raise MissionTextError(
            f"{first.place}: files that begin with {HEADER_WITHOUT_HOME} have no row of home, but "
            f"this one looks like it: a waypoint in frame {first.frame} before the take-off. Let "
            f"the file begin with {HEADER}, or remove the row{_count_again(rows)}."
        )


def _home(rows: Sequence[FileItem], name: str) -> tuple[float, float, float]:
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
