"""Mission files of other ground stations, as they stand: nothing interpreted, nothing dropped."""

from __future__ import annotations

from jfto_msgs_py.mission_file.document import FileItem, MissionDocument, MissionTextError
from jfto_msgs_py.mission_file.read import PLAN_SUFFIX, WPL_SUFFIXES, read_document

__all__ = [
    "PLAN_SUFFIX",
    "WPL_SUFFIXES",
    "FileItem",
    "MissionDocument",
    "MissionTextError",
    "read_document",
]
