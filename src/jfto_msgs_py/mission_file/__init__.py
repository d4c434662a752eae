"""Files of other programs, as they stand: waypoints and missions, read and written.

`read_any` reads all of them; `read_document` those that are missions of a vehicle.
"""

from __future__ import annotations

from jfto_msgs_py.mission_file.document import FileItem, MissionDocument, MissionTextError
from jfto_msgs_py.mission_file.formats import FORMATS, Document, Format, read_any
from jfto_msgs_py.mission_file.geo_plan import GeoArea, GeoPlan, GeoRoute, GeoStop
from jfto_msgs_py.mission_file.points import Above, FilePoint, PointDocument
from jfto_msgs_py.mission_file.read import PLAN_SUFFIX, WPL_SUFFIXES, read_document

__all__ = [
    "FORMATS",
    "PLAN_SUFFIX",
    "WPL_SUFFIXES",
    "Above",
    "Document",
    "FileItem",
    "FilePoint",
    "Format",
    "GeoArea",
    "GeoPlan",
    "GeoRoute",
    "GeoStop",
    "MissionDocument",
    "MissionTextError",
    "PointDocument",
    "read_any",
    "read_document",
]
