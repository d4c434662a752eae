"""The ground as one marker for RViz and Foxglove: triangles, shaded by slope."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from jfto_msgs_py.ros.stamps import encode_time
from jfto_msgs_py.ros.topics import MAP_FRAME
from jfto_msgs_py.types import Array

if TYPE_CHECKING:
    from jfto_world.terrain import Dem


# Cells are made larger where there would be more than this many: 100 bytes each on the network.
CELLS_MAX = 10_000
_LOW_COLOR, _HIGH_COLOR = np.array([0.62, 0.68, 0.55]), np.array([0.90, 0.87, 0.80])
# Light from the north-west, as on maps.
_LIGHT = np.array([-1.0, 1.0, 1.5]) / math.sqrt(4.25)


def terrain_triangles(dem: Dem, cell_m: float) -> tuple[Array, Array]:
    """Corners (T, 3, 3), ENU metres, and colours (T, 3), 0…1, of the area's ground.

    Cells are `cell_m` wide, or wider where CELLS_MAX of them do not suffice.
    """
    size = np.array(dem.size_m)
    cell_m = max(cell_m, math.sqrt(float(size.prod()) / CELLS_MAX))
    columns, rows = np.maximum(np.ceil(size / cell_m).astype(int), 1)
    x = np.linspace(-0.5, 0.5, columns + 1) * size[0]
    y = np.linspace(-0.5, 0.5, rows + 1) * size[1]
    east, north = np.meshgrid(x, y)
    corners = np.stack([east, north, dem.height(east, north)], axis=-1)
    south_west, south_east = corners[:-1, :-1], corners[:-1, 1:]
    north_west, north_east = corners[1:, :-1], corners[1:, 1:]
    below = np.stack([south_west, south_east, north_east], axis=-2).reshape(-1, 3, 3)
    above = np.stack([south_west, north_east, north_west], axis=-2).reshape(-1, 3, 3)
    triangles = np.concatenate([below, above])
    return triangles, _shaded(triangles)


def encode_terrain(dem: Dem, cell_m: float, stamp_ns: int) -> Any:
    """visualization_msgs/MarkerArray with the ground alone."""
    from geometry_msgs.msg import Point
    from std_msgs.msg import ColorRGBA
    from visualization_msgs.msg import Marker, MarkerArray

    triangles, colors = terrain_triangles(dem, cell_m)
    mesh = Marker(ns="terrain", id=0, type=Marker.TRIANGLE_LIST, action=Marker.ADD)
    mesh.header.frame_id = MAP_FRAME
    mesh.header.stamp = encode_time(stamp_ns)
    mesh.pose.orientation.w = 1.0
    mesh.scale.x = mesh.scale.y = mesh.scale.z = 1.0
    mesh.color.a = 1.0
    mesh.points = [Point(x=x, y=y, z=z) for x, y, z in triangles.reshape(-1, 3).tolist()]
    mesh.colors = [ColorRGBA(r=r, g=g, b=b, a=1.0) for r, g, b in colors.repeat(3, axis=0).tolist()]
    return MarkerArray(markers=[mesh])


def _shaded(triangles: Array) -> Array:
    heights = triangles[:, :, 2].mean(axis=1)
    share = (heights - heights.min()) / max(float(np.ptp(heights)), 1e-9)
    base = _LOW_COLOR + share[:, None] * (_HIGH_COLOR - _LOW_COLOR)
    normal = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    light = 0.55 + 0.45 * np.clip(normal @ _LIGHT, 0.0, 1.0)
    return np.asarray(base * light[:, None])
