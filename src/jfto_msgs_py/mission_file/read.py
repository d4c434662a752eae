"""A mission file told by its suffix."""

from __future__ import annotations

import dataclasses
from pathlib import Path

from jfto_msgs_py.errors import InputError
from jfto_msgs_py.mission_file.document import MissionDocument, MissionTextError
from jfto_msgs_py.mission_file.plan_json import parse_plan
from jfto_msgs_py.mission_file.wpl_text import parse_wpl_text
from jfto_msgs_py.text_encoding import read_foreign_text

PLAN_SUFFIX = ".plan"
WPL_SUFFIXES = (".waypoints", ".txt", ".wpl")
_LARGEST_BYTES = 64 * 2**20


def read_document(path: Path) -> MissionDocument:
    """What a mission file holds.

    Fence and rally points that lie beside a `.waypoints` file, as Mission Planner keeps them
    (`x.fence.waypoints`, `x.rally.waypoints`), come with it.

    Parameters
    ----------
    path
        A `.plan` or `.waypoints` file.

    Returns
    -------
    MissionDocument
        Its items, and notes on what is not used.

    Raises
    ------
    MissionTextError
        Names file, place, reason and cure.
    """
    suffix = path.suffix.lower()
    if suffix == PLAN_SUFFIX:
        text, notes = _text(path)
        document = parse_plan(text, str(path))
    elif suffix in WPL_SUFFIXES:
        text, notes = _text(path)
        document = _with_files_beside(parse_wpl_text(text, str(path)), path)
    else:
        raise MissionTextError(
            f"{path}: name must end in .plan or .waypoints. Export it as one of these; waypoints "
            "of other formats are planned over (waypoints.file)."
        )
    return dataclasses.replace(document, notes=(*notes, *document.notes))


def _text(path: Path) -> tuple[str, tuple[str, ...]]:
    try:
        text, encoding = read_foreign_text(path, "mission", _LARGEST_BYTES)
    except InputError as error:
        raise MissionTextError(str(error)) from None
    return text, (f"{path}: is not in UTF-8, read as {encoding.upper()}",) if encoding else ()


def _with_files_beside(document: MissionDocument, path: Path) -> MissionDocument:
    for name in ("fence", "rally"):
        beside = path.with_name(f"{path.stem}.{name}{path.suffix}")
        if not beside.exists():
            continue
        text, notes = _text(beside)
        part = parse_wpl_text(text, str(beside))
        if part.items:
            raise MissionTextError(
                f"{part.items[0].place}: is command {part.items[0].command}, but the file beside "
                f"{path.name} may hold its {name} only. Move it into the mission, or rename "
                f"{beside.name}."
            )
        document = dataclasses.replace(
            document,
            fence=document.fence + part.fence,
            rally=document.rally + part.rally,
            notes=(*document.notes, *notes, *part.notes),
        )
    return document
