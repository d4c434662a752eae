"""Paths, links and UAVs as markers for RViz and Foxglove."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from jfto_msgs_py.ros.stamps import encode_time
from jfto_msgs_py.ros.topics import MAP_FRAME
from jfto_msgs_py.types import Array
from jfto_topology.core import Scene

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


class FleetMarkers:
    """Draws a fleet over its paths (M, 3), ENU metres, by UAV.

    What stays from slot to slot is made once: a slot's time is for its topology.
    """

    def __init__(self, paths_m: Mapping[str, Array]) -> None:
        from visualization_msgs.msg import Marker

        self.paths_m = paths_m
        self._uav_ids = tuple(paths_m)
        self._clear = Marker(action=Marker.DELETEALL)
        self._paths = [
            _marker("paths", index, Marker.LINE_STRIP, _PATH_COLOR, points=_points(path_m))
            for index, path_m in enumerate(paths_m.values())
        ]
        self._balls, self._labels = [], []
        for index, uav in enumerate(paths_m):
            ball = _marker("uavs", index, Marker.SPHERE, _UAV_COLOR)
            ball.scale.x = ball.scale.y = ball.scale.z = _UAV_SIZE_M
            label = _marker("names", index, Marker.TEXT_VIEW_FACING, _UAV_COLOR, text=uav)
            label.scale.x, label.scale.z = 0.0, _LABEL_SIZE_M
            self._balls.append(ball)
            self._labels.append(label)

    def draw(self, scene: Scene) -> Any:
        """visualization_msgs/MarkerArray that replaces all that was drawn before.

        It is whole each time, so that a late joiner sees everything; the next call changes it.
        """
        from visualization_msgs.msg import MarkerArray

        stamp = encode_time(scene.stamp_ns)
        for index, uav in enumerate(self._uav_ids):
            color = _UAV_COLOR if uav in scene.linked_ids else _ALONE_COLOR
            east, north, up = scene.positions_m[index].tolist()
            _place(self._balls[index], color, east, north, up)
            _place(self._labels[index], color, east, north, up + _LABEL_SIZE_M)
        markers = [*self._paths, *self._links(scene), *self._balls, *self._labels]
        for marker in markers:
            marker.header.stamp = stamp
        return MarkerArray(markers=[self._clear, *markers])

    def _links(self, scene: Scene) -> list[Any]:
        from visualization_msgs.msg import Marker

        drawn: list[Any] = []
        for color, width_m, ends in _link_groups(scene, self._uav_ids):
            marker = _marker("links", len(drawn), Marker.LINE_LIST, color, points=_points(ends))
            marker.scale.x = width_m
            drawn.append(marker)
        return drawn


def _marker(namespace: str, number: int, kind: int, color: Color, **fields: Any) -> Any:
    from visualization_msgs.msg import Marker

    marker = Marker(ns=namespace, id=number, type=kind, action=Marker.ADD, **fields)
    marker.header.frame_id = MAP_FRAME
    marker.color.r, marker.color.g, marker.color.b = color
    marker.color.a = marker.scale.x = marker.pose.orientation.w = 1.0
    return marker


def _place(marker: Any, color: Color, east: float, north: float, up: float) -> None:
    marker.color.r, marker.color.g, marker.color.b = color
    point = marker.pose.position
    point.x, point.y, point.z = east, north, up


def _link_groups(scene: Scene, uav_ids: tuple[str, ...]) -> list[tuple[Color, float, Array]]:
    """Colour, width and ends (2 L, 3) of the links of each kind, weakest first."""
    position = dict(zip(uav_ids, scene.positions_m, strict=True))
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
