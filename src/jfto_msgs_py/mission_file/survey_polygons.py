"""The areas that a QGroundControl `.plan` was laid out for: polygons of its surveys."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from jfto_msgs_py.errors import InputError
from jfto_msgs_py.mission_file.document import MissionTextError, finite
from jfto_msgs_py.mission_file.plan_json import json_of_plan
from jfto_msgs_py.text_encoding import read_foreign_text

_LARGEST_BYTES = 64 * 2**20
_SURVEYS = ("survey", "StructureScan")


@dataclass(frozen=True)
class SurveyPolygon:
    """Latitude and longitude of each corner, degrees; `place` names file and item."""

    place: str
    kind: str
    corners_deg: tuple[tuple[float, float], ...]


def read_survey_polygons(path: Path) -> tuple[SurveyPolygon, ...]:
    """Polygons of the surveys and structure scans of a `.plan`, none where it has no such item.

    The items themselves are not read: a plan that only QGroundControl can expand will do. Raises
    MissionTextError.
    """
    try:
        text, _ = read_foreign_text(path, "mission", _LARGEST_BYTES)
    except InputError as error:
        raise MissionTextError(str(error)) from None
    document = json_of_plan(text, str(path))
    mission = document.get("mission") if isinstance(document, dict) else None
    items = mission.get("items") if isinstance(mission, dict) else None
    if not isinstance(items, list) or document.get("fileType") != "Plan":
        raise MissionTextError(
            f"{path}: is not a QGroundControl plan with a mission. Save it with Plan › Save."
        )
    return tuple(_polygons(items, str(path)))


def _polygons(items: list[Any], name: str) -> Iterator[SurveyPolygon]:
    for number, item in enumerate(items, start=1):
        kind = item.get("complexItemType") if isinstance(item, dict) else None
        if kind not in _SURVEYS:
            continue
        place = f"{name}, item {number} ({kind})"
        corners = item.get("polygon")
        if not isinstance(corners, list) or not corners:
            raise MissionTextError(f"{place}: has no polygon. Draw it again in QGroundControl.")
        yield SurveyPolygon(place, str(kind), tuple(_corner(c, place) for c in corners))


def _corner(value: Any, place: str) -> tuple[float, float]:
    if not isinstance(value, list) or len(value) < 2:
        raise MissionTextError(
            f"{place}: a corner of its polygon is {str(value)[:40]!r}, must be latitude and "
            "longitude. Save it again in QGroundControl."
        )
    return finite(value[0], "latitude", place), finite(value[1], "longitude", place)
