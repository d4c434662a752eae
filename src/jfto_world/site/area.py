"""The survey area of a scenario: polygons joined in its local frame, and where they must lie."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely

from jfto_msgs_py.errors import SiteError
from jfto_msgs_py.records.plan import Origin
from jfto_msgs_py.records.site import Polygon
from jfto_msgs_py.types import Array, Flags
from jfto_world.site.local import as_shapely, local_polygons, of_shapely
from jfto_world.site.rings import ring_polygon
from jfto_world.site.site_file import GeoPolygon
from jfto_world.terrain.area_grid import SEAM_CELLS
from jfto_world.terrain.frame import LocalFrame
from jfto_world.terrain.layer import Layer
from jfto_world.terrain.raster import around

SMALLEST_M2, LARGEST_M2 = 100.0, 2.5e9
# East and north grow with the origin's height: by so much at 9000 m, for windows cut at sea level.
_HIGH_ORIGIN = 1.0015
_SAMPLES = 60
_COMPASS = ("north", "north-east", "east", "south-east", "south", "south-west", "west",
            "north-west")  # fmt: skip


@dataclass(frozen=True)
class SiteArea:
    """Polygons in degrees, to be widened by `buffer_m`; `source` names key and file in errors."""

    source: str
    polygons: tuple[GeoPolygon, ...]
    buffer_m: float = 0.0
    notes: tuple[str, ...] = ()

    @property
    def middle_deg(self) -> tuple[float, float]:
        """Latitude and longitude of the middle of its bounds."""
        lat, lon = self._corners_deg()
        middle = float(lon.min() + lon.max()) / 2
        return float(lat.min() + lat.max()) / 2, float(around(np.array(middle), 0.0, 360.0))

    def _corners_deg(self) -> tuple[Array, Array]:
        lat, lon = np.array([c for one in self.polygons for c in one.outer_deg]).T
        return lat, around(lon, float(lon[0]), 360.0)

    def local(self, frame: LocalFrame) -> tuple[Polygon, ...]:
        """Its parts in the frame, joined where they overlap and widened.

        Raises SiteError where it is no area to survey: nothing left, below 100 m², above 2500 km².
        """
        parts = [as_shapely([one]) for one in local_polygons(self.polygons, frame)]
        joined = shapely.union_all(parts)
        if self.buffer_m:
            joined = shapely.buffer(joined, self.buffer_m)
        if joined.area < SMALLEST_M2:
            reason = f"nothing is left of it at area.buffer_m {self.buffer_m:g}"
            if joined.area > 0:
                reason = f"it is {joined.area:.1f} m² large, less than one photo shows"
            raise SiteError(
                f"{self.source}: {reason}. Check the units and corners of the file"
                + (", or set another area.buffer_m." if self.buffer_m else ".")
            )
        if joined.area > LARGEST_M2:
            raise SiteError(
                f"{self.source}: it is {joined.area / 1e6:.0f} km² large, more than any fleet "
                f"surveys ({LARGEST_M2 / 1e6:.0f} km²). Check its coordinates, or cut it."
            )
        return of_shapely(shapely.remove_repeated_points(joined, 1e-3))

    def window_m(self, center_deg: tuple[float, float]) -> tuple[float, float]:
        """East-west and north-south extent about a centre that holds the area."""
        parts = self.local(LocalFrame(Origin(*center_deg, 0.0)))
        west, south, east, north = as_shapely(parts).bounds
        return (
            2 * max(abs(west), abs(east)) * _HIGH_ORIGIN,
            2 * max(abs(south), abs(north)) * _HIGH_ORIGIN,
        )

    def require_on(self, layers: Sequence[Layer]) -> None:
        """Raise SiteError where elevation models hold no ground for all of it: how much, and where.

        Where it would lie on them with latitude and longitude exchanged, the error says so.
        """
        middle_deg = self.middle_deg
        frame = LocalFrame(Origin(*middle_deg, 0.0))
        points = _points(self.local(frame))
        lat, lon, _ = frame.to_geodetic(np.column_stack([points, np.zeros(len(points))]))
        held = _held(layers, lat, lon)
        if held.all():
            return
        names = " and ".join(layer.name for layer in layers[:3])
        terrain = f"{names}, which holds {' and '.join(one.extent_text() for one in layers[:3])}"
        if held.any():
            raise SiteError(
                f"{self.source}: {100 * np.mean(~held):.0f} % of it, its {_side(points, held)}, "
                f"lies outside of the terrain, {terrain}. Take a larger elevation model, or cut "
                "the area."
            )
        at = f"it lies at {middle_deg[0]:.4f}, {middle_deg[1]:.4f}"
        if np.abs(lon).max() <= 90 and _held(layers, lon, lat).all():
            raise SiteError(
                f"{self.source}: its latitude and longitude are exchanged: as given {at}, outside "
                "of the terrain, and within when exchanged. Exchange them."
            )
        raise SiteError(
            f"{self.source}: {at}, outside of the terrain, {terrain}. Name the elevation model of "
            "the area (terrain.source)."
        )


def polygon_area(corners_deg: Sequence[float], buffer_m: float) -> SiteArea:
    """Area of area.polygon_deg.

    Parameters
    ----------
    corners_deg
        Latitude and longitude in turn.
    buffer_m
        How far it is widened.

    Returns
    -------
    SiteArea
        One polygon.

    Raises
    ------
    SiteError
        The ring crosses itself, or has fewer than 3 corners.
    """
    pairs = zip(corners_deg[::2], corners_deg[1::2], strict=True)
    ring = tuple((lat, lon - 360.0 if lon > 180 else lon) for lat, lon in pairs)
    ring = ring[:-1] if ring[0] == ring[-1] else ring
    return SiteArea("area.polygon_deg", ring_polygon(ring, "area.polygon_deg"), buffer_m)


def _points(parts: tuple[Polygon, ...]) -> Array:
    """Corners of an area and points all over it (K, 2)."""
    shape = as_shapely(parts)
    west, south, east, north = shape.bounds
    grid = np.meshgrid(np.linspace(west, east, _SAMPLES), np.linspace(south, north, _SAMPLES))
    inner = np.column_stack([axis.ravel() for axis in grid])
    inner = inner[shapely.contains_xy(shape, *inner.T)]
    return np.concatenate([inner, [corner for part in parts for corner in part.outer]])


def _held(layers: Sequence[Layer], lat: Array, lon: Array) -> Flags:
    """Whether one of the layers has cells at places; across a seam as `load_dem` takes them."""
    beyond = 0.0 if len(layers) == 1 else SEAM_CELLS
    found: Flags = np.any([layer.covers(lat, lon, beyond) for layer in layers], axis=0)
    return found


def _side(points: Array, held: Flags) -> str:
    """Which part of an area is not held, as a point of the compass from its middle."""
    east, north = points[~held].mean(axis=0) - points.mean(axis=0)
    return f"{_COMPASS[round(np.degrees(np.arctan2(east, north)) / 45) % 8]} part"
