"""Writes one UAV's route as a DJI wayline (WPML): a KMZ of template.kml and waylines.wpml.

Format: the DJI WPML pages of the Cloud API documentation. Heights are above the pad.
"""

from __future__ import annotations

import math
from itertools import pairwise
from xml.etree import ElementTree as ET

from jfto_msgs_py.mission_file.build_xml import KML_SPACE, add, archive, as_bytes, lon_lat
from jfto_msgs_py.mission_file.document import MissionTextError
from jfto_msgs_py.mission_file.geo_plan import GeoPlan, GeoRoute, GeoStop, Position

_SPACE = "http://www.dji.com/wpmz/1.0.2"
# Type and subtype of the drone, and its camera, as DJI numbers them.
DRONES = {
    "M30": (67, 0, 52),
    "M30T": (67, 1, 53),
    "M3E": (77, 0, 66),
    "M3T": (77, 1, 67),
    "M3M": (77, 2, 68),
    "M3D": (91, 0, 80),
    "M3TD": (91, 1, 81),
}
DEFAULT_DRONE = "M3E"
_TAKE_OFF_M = 20
_FASTEST_MPS = 15.0
_EARTH_M = 6_371_000.0


def write_wpml(plan: GeoPlan) -> bytes:
    """The archive of the plan's one route. Raises MissionTextError for none with a pad."""
    (route,) = plan.routes
    if route.home is None or not route.stops:
        raise MissionTextError(
            f"{plan.name}: a wayline's heights are above take-off, and it has waypoints; this has "
            f"{'no pad' if route.home is None else 'none'}. Export it as CSV or KML."
        )
    return archive(
        {
            "wpmz/template.kml": as_bytes(_template(plan, route, route.home)),
            "wpmz/waylines.wpml": as_bytes(_waylines(plan, route, route.home)),
        }
    )


def _root(plan: GeoPlan, home: Position) -> tuple[ET.Element, ET.Element]:
    root = ET.Element("kml", {"xmlns": KML_SPACE, "xmlns:wpml": _SPACE})
    document = add(root, "Document")
    config = _add(document, "missionConfig")
    _values(
        config,
        flyToWaylineMode="safely",
        finishAction="goHome",
        exitOnRCLost="executeLostAction",
        executeRCLostAction="goBack",
        takeOffSecurityHeight=_TAKE_OFF_M,
        takeOffRefPoint=f"{home[0]:.9f},{home[1]:.9f},{home[2]:.3f}",
        takeOffRefPointAGLHeight=0,
        globalTransitionalSpeed=f"{min(plan.routes[0].speed_mps, _FASTEST_MPS):g}",
    )
    kind, sub_kind, camera = DRONES[plan.drone or DEFAULT_DRONE]
    _values(_add(config, "droneInfo"), droneEnumValue=kind, droneSubEnumValue=sub_kind)
    _values(_add(config, "payloadInfo"), payloadEnumValue=camera, payloadPositionIndex=0)
    return root, document


def _template(plan: GeoPlan, route: GeoRoute, home: Position) -> ET.Element:
    """What DJI's programs edit."""
    root, document = _root(plan, home)
    author = _add(document, "author", plan.name)
    document.remove(author)
    document.insert(0, author)
    folder = add(document, "Folder")
    _values(folder, templateType="waypoint", templateId=0)
    _values(
        _add(folder, "waylineCoordinateSysParam"),
        coordinateMode="WGS84",
        heightMode="relativeToStartPoint",
    )
    _values(
        folder,
        autoFlightSpeed=_speed(route),
        globalHeight=f"{route.stops[0].at[2] - home[2]:.3f}",
        gimbalPitchMode="usePointSetting",
        globalWaypointTurnMode="toPointAndStopWithDiscontinuityCurvature",
        globalUseStraightLine=1,
    )
    _values(_add(folder, "globalWaypointHeadingParam"), waypointHeadingMode="smoothTransition")
    for index, stop in enumerate(route.stops):
        mark = _mark(folder, stop, index)
        above = f"{stop.at[2] - home[2]:.3f}"
        _values(mark, ellipsoidHeight=above, height=above, useGlobalHeight=0, useGlobalSpeed=1)
        _values(mark, useGlobalHeadingParam=0, useGlobalTurnParam=1)
        _heading(mark, stop)
        _values(mark, gimbalPitchAngle=f"{stop.pitch_deg:.6f}")
        _actions(mark, stop, index)
    return root


def _waylines(plan: GeoPlan, route: GeoRoute, home: Position) -> ET.Element:
    """What the drone flies."""
    root, document = _root(plan, home)
    folder = add(document, "Folder")
    length_m = sum(_apart_m(a.at, b.at) for a, b in pairwise(route.stops))
    _values(
        folder,
        templateId=0,
        executeHeightMode="relativeToStartPoint",
        waylineId=0,
        distance=f"{length_m:.1f}",
        duration=f"{length_m / max(route.speed_mps, 0.1):.1f}",
        autoFlightSpeed=_speed(route),
    )
    for index, stop in enumerate(route.stops):
        mark = _mark(folder, stop, index)
        _values(mark, executeHeight=f"{stop.at[2] - home[2]:.3f}", waypointSpeed=_speed(route))
        _heading(mark, stop)
        turn = _add(mark, "waypointTurnParam")
        _values(
            turn,
            waypointTurnMode="toPointAndStopWithDiscontinuityCurvature",
            waypointTurnDampingDist=0,
        )
        _values(mark, useStraightLine=1)
        _actions(mark, stop, index)
    return root


def _add(parent: ET.Element, name: str, text: object = None) -> ET.Element:
    return add(parent, f"wpml:{name}", text)


def _values(parent: ET.Element, **values: object) -> None:
    for name, value in values.items():
        _add(parent, name, value)


def _speed(route: GeoRoute) -> str:
    return f"{min(route.speed_mps, _FASTEST_MPS):g}"


def _mark(folder: ET.Element, stop: GeoStop, index: int) -> ET.Element:
    mark = add(folder, "Placemark")
    add(add(mark, "Point"), "coordinates", lon_lat(*stop.at[:2]))
    _values(mark, index=index)
    return mark


def _heading(mark: ET.Element, stop: GeoStop) -> None:
    angle = (stop.yaw_deg + 180.0) % 360.0 - 180.0
    _values(
        _add(mark, "waypointHeadingParam"),
        waypointHeadingMode="smoothTransition",
        waypointHeadingAngle=f"{angle:.6f}",
        waypointPoiPoint="0.000000,0.000000,0.000000",
        waypointHeadingAngleEnable=1,
        waypointHeadingPathMode="followBadArc",
    )


def _actions(mark: ET.Element, stop: GeoStop, index: int) -> None:
    """On reaching the waypoint: tilt, and take the photo where it has one."""
    group = _add(mark, "actionGroup")
    _values(
        group,
        actionGroupId=index,
        actionGroupStartIndex=index,
        actionGroupEndIndex=index,
        actionGroupMode="sequence",
    )
    _values(_add(group, "actionTrigger"), actionTriggerType="reachPoint")
    tilt = _add(group, "action")
    _values(tilt, actionId=0, actionActuatorFunc="gimbalRotate")
    _values(
        _add(tilt, "actionActuatorFuncParam"),
        gimbalHeadingYawBase="aircraft",
        gimbalRotateMode="absoluteAngle",
        gimbalPitchRotateEnable=1,
        gimbalPitchRotateAngle=f"{stop.pitch_deg:.6f}",
        gimbalRollRotateEnable=0,
        gimbalRollRotateAngle=0,
        gimbalYawRotateEnable=0,
        gimbalYawRotateAngle=0,
        gimbalRotateTimeEnable=0,
        gimbalRotateTime=0,
        payloadPositionIndex=0,
    )
    if stop.photo:
        shot = _add(group, "action")
        _values(shot, actionId=1, actionActuatorFunc="takePhoto")
        _values(
            _add(shot, "actionActuatorFuncParam"),
            fileSuffix=f"waypoint{stop.number}",
            payloadPositionIndex=0,
        )


def _apart_m(one: Position, other: Position) -> float:
    north, turn = (math.radians(other[k] - one[k]) for k in range(2))
    east = turn * math.cos(math.radians(one[0]))
    return math.hypot(_EARTH_M * north, _EARTH_M * east, other[2] - one[2])
