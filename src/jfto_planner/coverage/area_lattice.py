"""Points for the centres of photos over polygons: rows in any direction, cut where the area ends.

The area is divided into strips of one row each, measured along the surface. Of each strip only the
stretches that hold ground of the area get points.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import shapely

from jfto_msgs_py.types import Array, Flags
from jfto_planner.coverage.targets import check_count
from jfto_world.terrain import CubicSurface

_SAMPLES_PER_SPACING = 24
_FEWEST_SAMPLES = 48
_MOST_SAMPLES = 2_000


@dataclass(frozen=True)
class TurnedFrame:
    """Coordinates (u, v): u along rows that head `heading_deg` (0 is north), v to their left."""

    heading_deg: float

    @property
    def _axes(self) -> tuple[Array, Array]:
        heading = math.radians(self.heading_deg)
        along = np.array([math.sin(heading), math.cos(heading)])
        return along, np.array([-along[1], along[0]])

    def turned(self, points: Array) -> Array:
        """(u, v) of points (..., 2)."""
        return points @ np.stack(self._axes, axis=-1)

    def map(self, u: Array, v: Array) -> tuple[Array, Array]:
        """East and north of (u, v)."""
        along, left = self._axes
        return u * along[0] + v * left[0], u * along[1] + v * left[1]


def area_lattice(
    surface: CubicSurface,
    area: shapely.MultiPolygon,
    heading_deg: float,
    spacing_m: tuple[float, float],
    max_points: int,
) -> Array:
    """Points (W, 2), east and north, at most `spacing_m` apart along and across rows.

    Measured along the surface. Parts further apart than a photo reaches get rows of their own.
    Raises InfeasibleError beyond `max_points`.
    """
    check_count(math.ceil(area.area / (spacing_m[0] * spacing_m[1])), max_points)
    frame = TurnedFrame(heading_deg)
    points: list[Array] = []
    for group in _groups(area, max(spacing_m)):
        points += _rows(surface, group, frame, spacing_m)
        check_count(sum(map(len, points)), max_points)
    return np.concatenate(points)


def _groups(area: shapely.MultiPolygon, reach_m: float) -> list[shapely.MultiPolygon]:
    """Parts that lie within reach of one another, together."""
    parts = shapely.get_parts(area)
    if len(parts) == 1:
        return [area]
    wide = shapely.union_all(shapely.buffer(parts, reach_m / 2))
    groups = []
    for blob in shapely.get_parts(wide):
        inside = parts[shapely.intersects(blob, parts)]
        groups.append(shapely.MultiPolygon(list(inside)))
    return groups


def _rows(
    surface: CubicSurface,
    area: shapely.MultiPolygon,
    frame: TurnedFrame,
    spacing_m: tuple[float, float],
) -> list[Array]:
    """Points of each row (K, 2)."""
    turned = shapely.transform(area, frame.turned)
    shapely.prepare(turned)
    west, south, east, north = turned.bounds
    u = _samples(west, east, spacing_m[0])
    v = _samples(south, north, spacing_m[1])
    grid_u, grid_v = np.meshgrid(u, v)
    z = _height(surface, frame, grid_u, grid_v)
    inside = shapely.contains_xy(turned, grid_u, grid_v)

    # Beside the area the surface does not count: a cliff there must not crowd the rows.
    rise = np.diff(z, axis=0) * (inside[1:] | inside[:-1])
    arcs = np.concatenate(
        [np.zeros((1, len(u))), np.cumsum(np.hypot(np.diff(v)[:, None], rise), 0)]
    )
    rows = max(1, math.ceil(arcs[-1].max() / spacing_m[1] - 1e-9))
    edges = np.stack([_at(arcs, v, k / rows) for k in range(rows + 1)])
    held = _held_in_strips(inside, v, edges)
    found = []
    for row in range(rows):
        middle_v = _at(arcs, v, (row + 0.5) / rows)
        steps = np.hypot(np.diff(u), np.diff(middle_v))
        rise = np.diff(_height(surface, frame, u, middle_v)) * (held[row, 1:] | held[row, :-1])
        arc = np.concatenate([[0.0], np.cumsum(np.hypot(steps, rise))])
        for first, last in _stretches(held[row], arc, spacing_m[0]):
            parts = max(1, math.ceil((arc[last] - arc[first]) / spacing_m[0] - 1e-9))
            cuts = arc[first] + (np.arange(parts) + 0.5) / parts * (arc[last] - arc[first])
            row_u = np.interp(cuts, arc, u)
            found.append(np.stack(frame.map(row_u, np.interp(row_u, u, middle_v)), axis=-1))
    return found


def _samples(low: float, high: float, spacing_m: float) -> Array:
    count = math.ceil(_SAMPLES_PER_SPACING * (high - low) / spacing_m)
    count = min(max(_FEWEST_SAMPLES, count), _MOST_SAMPLES)
    # From edge to edge, but inside of it: a sample on the outline would be in or out by chance.
    slack = 1e-6 * (high - low)
    return np.linspace(low + slack, high - slack, count + 1)


def _height(surface: CubicSurface, frame: TurnedFrame, u: Array, v: Array) -> Array:
    """Ground heights; corners of the turned bounds beyond the surface have its edge's."""
    east, north = frame.map(u, v)
    rows, columns = surface.shape
    x = sorted((surface.x0, surface.x0 + (columns - 1) * surface.step_x))
    y = sorted((surface.y0, surface.y0 + (rows - 1) * surface.step_y))
    return surface.height_and_gradient(np.clip(east, x[0], x[1]), np.clip(north, y[0], y[1]))[0]


def _at(arcs: Array, v: Array, share: float) -> Array:
    """For each column where the share of its whole arc is reached."""
    return np.array([np.interp(share * column[-1], column, v) for column in arcs.T])


def _held_in_strips(inside: Flags, v: Array, edges: Array) -> Flags:
    """Whether strip k, between `edges[k]` and `edges[k + 1]`, holds area at each column."""
    count = np.concatenate([np.zeros((1, inside.shape[1]), dtype=int), np.cumsum(inside, axis=0)])
    index = np.searchsorted(v, edges.ravel()).reshape(edges.shape)
    columns = np.arange(inside.shape[1])
    index[-1] = len(v)
    held: Flags = count[index[1:], columns] > count[index[:-1], columns]
    return held


def _stretches(held: Flags, arc: Array, spacing_m: float) -> list[tuple[int, int]]:
    """First and last column of each run, runs joined where that takes no more points."""
    change = np.flatnonzero(np.diff(np.concatenate([[False], held, [False]]).astype(int)))
    runs: list[tuple[int, int]] = []

    def points(first: int, last: int) -> int:
        return max(1, math.ceil(float(arc[last] - arc[first]) / spacing_m - 1e-9))

    for first, last in zip(change[::2], change[1::2] - 1, strict=True):
        if runs and points(runs[-1][0], last) <= points(*runs[-1]) + points(first, last):
            runs[-1] = (runs[-1][0], int(last))
        else:
            runs.append((int(first), int(last)))
    return runs
