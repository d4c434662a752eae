"""The ground under a scenario, in its local frame."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from jfto_msgs_py.errors import TerrainError
from jfto_msgs_py.records.plan import Origin
from jfto_msgs_py.records.site import Polygon
from jfto_msgs_py.types import Array
from jfto_world.terrain.cubic_surface import CubicSurface, cell_ceilings, first_hit
from jfto_world.terrain.frame import LocalFrame

if TYPE_CHECKING:
    import shapely


@dataclass(frozen=True)
class Dem:
    """Bicubic ground surface over the area and a margin around it.

    The area is the polygons of `area`, which lie within `size_m` (east-west, north-south) metres
    about the origin, or all of that rectangle where `area` is empty. Heights are z in ENU metres,
    0 at the origin, whose altitude is above sea level as `height_datum` has it. Whatever asks for
    ground beyond `half_extent_m` gets a TerrainError, never a made-up height. `notes` say in a line
    each what was taken for granted.

    Photos are taken of the ground. What flies must clear `top`, and rays end there: the ground or
    what stands on it (trees, roofs), whichever is higher; None where only the ground is known.
    """

    origin: Origin
    size_m: tuple[float, float]
    half_extent_m: tuple[float, float]
    surface: CubicSurface
    height_datum: str
    description: str
    notes: tuple[str, ...] = ()
    area: tuple[Polygon, ...] = ()
    top: CubicSurface | None = None

    @cached_property
    def area_shape(self) -> shapely.MultiPolygon:
        """The area as shapely takes it, in ENU metres."""
        # Loaded here: most who need ground know nothing of polygons.
        import shapely

        east, north = (side / 2 for side in self.size_m)
        box = ((-east, -north), (east, -north), (east, north), (-east, north))
        parts = [(part.outer, part.holes) for part in self.area] or [(box, ())]
        shape = shapely.MultiPolygon(parts)
        shapely.prepare(shape)
        return shape

    def in_area(self, x_m: ArrayLike, y_m: ArrayLike) -> NDArray[np.bool_]:
        """Whether points of any shape lie in the area."""
        if not self.area:
            return (np.abs(x_m) <= self.size_m[0] / 2) & (np.abs(y_m) <= self.size_m[1] / 2)
        import shapely

        found: NDArray[np.bool_] = shapely.contains_xy(self.area_shape, x_m, y_m)
        return found

    @cached_property
    def frame(self) -> LocalFrame:
        """The local frame about the origin."""
        return LocalFrame(self.origin)

    def to_enu(self, lat_deg: ArrayLike, lon_deg: ArrayLike, alt_m: ArrayLike) -> Array:
        """ENU metres (..., 3) of WGS-84 degrees and altitudes in the DEM's height datum."""
        return self.frame.to_enu(lat_deg, lon_deg, alt_m)

    def to_geodetic(self, position_m: ArrayLike) -> tuple[Array, Array, Array]:
        """Latitude, longitude (degrees) and altitude (m, DEM's datum) of ENU (..., 3)."""
        return self.frame.to_geodetic(position_m)

    def contains(self, x_m: ArrayLike, y_m: ArrayLike) -> NDArray[np.bool_]:
        """Whether the ground under points is known: the area with its margin."""
        return self.surface.contains(
            np.asarray(x_m, dtype=np.float64), np.asarray(y_m, dtype=np.float64)
        )

    def height(self, x_m: ArrayLike, y_m: ArrayLike) -> Array:
        """Ground height z in metres at points of any shape. Raises TerrainError outside."""
        return self.height_and_gradient(x_m, y_m)[0]

    def height_and_gradient(self, x_m: ArrayLike, y_m: ArrayLike) -> tuple[Array, Array, Array]:
        """Ground height and its slopes eastwards and northwards. Raises TerrainError outside."""
        x, y = (np.asarray(v, dtype=np.float64) for v in np.broadcast_arrays(x_m, y_m))
        self._check_inside(x, y)
        return self.surface.height_and_gradient(x, y)

    def top_height(self, x_m: ArrayLike, y_m: ArrayLike) -> Array:
        """Height z of what must be cleared at points of any shape. Raises TerrainError outside."""
        x, y = (np.asarray(v, dtype=np.float64) for v in np.broadcast_arrays(x_m, y_m))
        self._check_inside(x, y)
        return self._top.height_and_gradient(x, y)[0]

    def normal(self, x_m: ArrayLike, y_m: ArrayLike) -> Array:
        """Unit vector (..., 3) that stands on the ground, pointing up. TerrainError outside."""
        _, east, north = self.height_and_gradient(x_m, y_m)
        normal = np.stack([-east, -north, np.ones_like(east)], axis=-1)
        return normal / np.linalg.norm(normal, axis=-1, keepdims=True)

    def grid(self) -> tuple[Array, Array, Array]:
        """The surface's own nodes, for drawing: x (nx,), y (ny,), z (ny, nx)."""
        rows, columns = self.surface.shape
        x = self.surface.x0 + self.surface.step_x * np.arange(columns, dtype=np.float64)
        y = self.surface.y0 + self.surface.step_y * np.arange(rows, dtype=np.float64)
        return x, y, self.surface.height_and_gradient(*np.meshgrid(x, y))[0]

    def first_hit(
        self, origin_m: ArrayLike, direction: ArrayLike, max_range_m: ArrayLike = np.inf
    ) -> Array:
        """Distance (K,) in metres at which rays first touch the top; inf where they do not.

        `origin_m` and `direction` (any length but 0) have shape (K, 3) or broadcast to it. A ray
        from below it hits at 0; beyond the margin there is nothing to hit.
        """
        origin, direction_ = np.broadcast_arrays(
            np.atleast_2d(np.asarray(origin_m, dtype=np.float64)),
            np.atleast_2d(np.asarray(direction, dtype=np.float64)),
        )
        length = np.linalg.norm(direction_, axis=-1, keepdims=True)
        if not (np.isfinite(origin).all() and np.isfinite(length).all() and (length > 0).all()):
            raise TerrainError(
                "A ray has a direction of zero length or a coordinate that is not a number. "
                "Give finite positions and directions."
            )
        reach = np.broadcast_to(np.asarray(max_range_m, dtype=np.float64), (len(origin),))
        return first_hit(self._top, self._ceilings, origin, direction_ / length, reach)

    def sees(self, from_m: ArrayLike, to_m: ArrayLike, slack_m: float = 0.1) -> NDArray[np.bool_]:
        """Whether nothing stands in the straight line between pairs of points, (K, 3) each.

        `slack_m` is how close to `to_m` the line may touch, so that points on the ground count.
        Where something stands on a point it is seen if the top of that is: a photo of a wood shows
        its crowns.
        """
        start, end = np.broadcast_arrays(
            np.atleast_2d(np.asarray(from_m, dtype=np.float64)),
            np.atleast_2d(np.asarray(to_m, dtype=np.float64)),
        )
        if self.top is not None:
            end = end.copy()
            over = self.contains(end[:, 0], end[:, 1])
            end[over, 2] = np.maximum(end[over, 2], self.top_height(*end[over, :2].T))
        distance = np.linalg.norm(end - start, axis=-1)
        free = distance <= slack_m
        far = ~free
        reach = distance[far] - slack_m
        free[far] = np.isinf(self.first_hit(start[far], (end - start)[far], reach))
        return free

    @cached_property
    def _ceilings(self) -> Array:
        return cell_ceilings(self._top)

    @property
    def _top(self) -> CubicSurface:
        return self.surface if self.top is None else self.top

    def _check_inside(self, x: Array, y: Array) -> None:
        inside = self.surface.contains(x, y)
        if inside.all():
            return
        first = tuple(np.argwhere(~inside)[0])
        raise TerrainError(
            f"Point x = {x[first]:.1f} m, y = {y[first]:.1f} m lies outside the terrain, which "
            f"reaches ±{self.half_extent_m[0]:.0f} m east and ±{self.half_extent_m[1]:.0f} m "
            "north of its origin. Load it with a larger margin_m, or move the point."
        )
