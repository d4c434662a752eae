"""Paths, links and UAVs as markers for RViz and Foxglove."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from jfto_msgs_py.ros.stamps import encode_time
from jfto_msgs_py.ros.topics import MAP_FRAME

Array = NDArray[np.float64]
Color = tuple[float, float, float]

# Margin below which a link looks so (dB), its colour and width (m): told apart without colour too.
LINK_LOOKS: tuple[tuple[float, Color, float], ...] = (
    (1.0, (0.84, 0.37, 0.0), 8.0),
    (3.0, (0.90, 0.62, 0.0), 5.0),
    (float("inf"), (0.0, 0.45, 0.70), 2.5),
)
_PATH_COLOR: Color = (0.55, 0.55, 0.55)
_UAV_COLOR: Color = (0.0, 0.62, 0.45)
_ALONE_COLOR: Color = (0.0, 0.0, 0.0)
_UAV_SIZE_M = 15.0
_LABEL_SIZE_M = 20.0


@dataclass(frozen=True)
class Scene:
    """What is drawn: every UAV's path (M, 3) and position (A, 3), ENU metres.

    `links` (L, L) and `margins_db` (L, L) are over `linked_ids`, the UAVs that take part.
    """

    stamp_ns: int
    uav_ids: tuple[str, ...]
    paths_m: dict[str, Array]
    positions_m: Array
    linked_ids: tuple[str, ...]
    links: NDArray[np.bool_]
    margins_db: Array


def encode_markers(scene: Scene) -> Any:
    """visualization_msgs/MarkerArray that replaces all that was drawn before.

    It is whole each time, so that a late joiner sees everything.
    """
    from visualization_msgs.msg import Marker, MarkerArray

    markers: list[Any] = []

    def add(namespace: str, kind: int, color: Color, size_m: float, **fields: Any) -> Any:
        marker = Marker(ns=namespace, id=len(markers), type=kind, action=Marker.ADD, **fields)
        marker.header.frame_id = MAP_FRAME
        marker.header.stamp = encode_time(scene.stamp_ns)
        marker.color.r, marker.color.g, marker.color.b = color
        marker.color.a = 1.0
        marker.scale.x = size_m
        marker.pose.orientation.w = 1.0
        markers.append(marker)
        return marker

    for uav in scene.uav_ids:
        add("paths", Marker.LINE_STRIP, _PATH_COLOR, 1.0, points=_points(scene.paths_m[uav]))
    for color, width_m, ends in _link_groups(scene):
        add("links", Marker.LINE_LIST, color, width_m, points=_points(ends))
    for uav, position in zip(scene.uav_ids, scene.positions_m, strict=True):
        color = _UAV_COLOR if uav in scene.linked_ids else _ALONE_COLOR
        ball = add("uavs", Marker.SPHERE, color, _UAV_SIZE_M)
        ball.scale.y = ball.scale.z = _UAV_SIZE_M
        _place(ball, position)
        label = add("names", Marker.TEXT_VIEW_FACING, color, 0.0, text=uav)
        label.scale.z = _LABEL_SIZE_M
        _place(label, position + np.array([0.0, 0.0, _LABEL_SIZE_M]))
    return MarkerArray(markers=[Marker(action=Marker.DELETEALL), *markers])


def _link_groups(scene: Scene) -> list[tuple[Color, float, Array]]:
    """Colour, width and ends (2 L, 3) of the links of each kind, weakest first."""
    position = dict(zip(scene.uav_ids, scene.positions_m, strict=True))
    groups, low = [], -np.inf
    for high, color, width_m in LINK_LOOKS:
        drawn = scene.links & (scene.margins_db >= low) & (scene.margins_db < high)
        pairs = np.argwhere(np.triu(drawn))
        ends = [position[scene.linked_ids[end]] for pair in pairs for end in pair]
        if ends:
            groups.append((color, width_m, np.array(ends)))
        low = high
    return groups


def _points(line_m: Array) -> list[Any]:
    from geometry_msgs.msg import Point

    return [Point(x=x, y=y, z=z) for x, y, z in line_m.tolist()]


def _place(marker: Any, position_m: Array) -> None:
    point = marker.pose.position
    point.x, point.y, point.z = (float(value) for value in position_m)
