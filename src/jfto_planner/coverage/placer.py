"""From points on the map to waypoints, and the smooth surface that normals are taken from."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy import ndimage

from jfto_msgs_py.records.plan import Vector, Waypoint
from jfto_msgs_py.types import Array
from jfto_planner.coverage.aim import aim
from jfto_planner.coverage.settings import CoverageSettings
from jfto_world.terrain import CubicSurface, Dem


@dataclass(frozen=True)
class CoverageNote:
    """What became of one photo that could not be taken as wished.

    `action` is "moved", "dropped" or "added"; `waypoint_id` is None for a dropped one.
    """

    action: str
    waypoint_id: int | None
    reason: str


@dataclass(frozen=True)
class Placer:
    """Turns points on the map into waypoints.

    Photos of level ground have their upper edge towards `heading_deg`.
    """

    dem: Dem
    surface: CubicSurface
    distance_m: float
    heading_deg: float
    settings: CoverageSettings

    def place(
        self, points: Array, first_id: int, added: str
    ) -> tuple[list[Waypoint], list[CoverageNote]]:
        """Waypoints for points (K, 2), and notes on those changed, or `added` for that reason."""
        z, east, north = self.surface.height_and_gradient(points[:, 0], points[:, 1])
        normal = np.stack([-east, -north, np.ones_like(east)], axis=-1)
        normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
        target = np.column_stack([points, z])
        aimed = aim(self.dem, target, normal, self.distance_m, self.heading_deg, self.settings)
        waypoints: list[Waypoint] = []
        notes: list[CoverageNote] = []
        for k in range(len(points)):
            if not aimed.possible[k]:
                notes.append(CoverageNote("dropped", None, aimed.reason[k]))
                continue
            number = first_id + len(waypoints)
            waypoints.append(
                Waypoint(
                    number,
                    _vector(aimed.position_m[k]),
                    float(aimed.yaw_deg[k]),
                    float(aimed.pitch_deg[k]),
                )
            )
            if added:
                notes.append(CoverageNote("added", number, added))
            if aimed.reason[k]:
                gap_m = math.dist(_vector(aimed.position_m[k]), _vector(aimed.wished_m[k]))
                text = f"{aimed.reason[k]}; taken {gap_m:.0f} m from the place on the normal"
                notes.append(CoverageNote("moved", number, text))
        return waypoints, notes


def _vector(values: Array) -> Vector:
    x, y, z = (float(v) for v in values)
    return x, y, z


def smooth_surface(dem: Dem, sigma_m: float) -> CubicSurface:
    """Bicubic surface of the ground after a Gaussian filter of standard deviation `sigma_m`."""
    x, y, z = dem.grid()
    step_x, step_y = float(x[1] - x[0]), float(y[1] - y[0])
    # Reflected oddly, a slope goes on beyond the edge instead of levelling out.
    reach = int(np.ceil(4 * sigma_m / min(step_x, step_y))) + 1
    padded = np.pad(z, reach, mode="reflect", reflect_type="odd")
    smooth = ndimage.gaussian_filter(padded, (sigma_m / step_y, sigma_m / step_x))
    inner = smooth[reach:-reach, reach:-reach]
    return CubicSurface.through(inner, float(x[0]), float(y[0]), step_x, step_y)
