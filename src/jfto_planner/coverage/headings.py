"""Which way the rows of a grid may run."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import shapely

from jfto_msgs_py.types import Array
from jfto_world.terrain import CubicSurface, Dem

_STEP_DEG = 5.0
# So many of the headings that take the fewest points are tried to the end.
_TRIED = 2
# Nearer than this two headings are one.
_SAME_DEG = 4.0
_SAMPLES = 64


def rows_run_east(surface: CubicSurface, dem: Dem) -> bool:
    """Whether slopes face north or south rather than east or west.

    A frontal camera's long side lies along the contour lines, and rows should run that way too.
    """
    x, y = (np.linspace(-side / 2, side / 2, _SAMPLES) for side in dem.size_m)
    _, east, north = surface.height_and_gradient(*np.meshgrid(x, y))
    return bool((north**2).sum() >= (east**2).sum())


def likely_headings(
    surface: CubicSurface, dem: Dem, count_points: Callable[[float], int]
) -> tuple[float, ...]:
    """Headings in degrees, 0 to 180, one of which takes the fewest waypoints for an area.

    Along the contour lines, where frontal photos fit the grid; and those with the fewest points,
    which `count_points` counts, where the outline matters more.
    """
    steps = [*np.arange(0.0, 180.0, _STEP_DEG), *_sides_deg(dem)]
    by_count = sorted(steps, key=lambda heading: (count_points(heading), heading))
    found: list[float] = []
    for heading in [_contours_deg(surface, dem), *by_count]:
        if all(abs((heading - other + 90) % 180 - 90) >= _SAME_DEG for other in found):
            found.append(float(heading))
        if len(found) > _TRIED:
            break
    return tuple(found)


def _contours_deg(surface: CubicSurface, dem: Dem) -> float:
    """Mean direction of the area's contour lines, steep ground counting most."""
    west, south, east, north = dem.area_shape.bounds
    grid = np.meshgrid(np.linspace(west, east, _SAMPLES), np.linspace(south, north, _SAMPLES))
    points = [axis[dem.in_area(*grid)] for axis in grid]
    _, slope_east, slope_north = surface.height_and_gradient(*points)
    # Doubled angles, since opposite slopes have the same contour lines.
    double = math.atan2(
        float(2 * (slope_east * slope_north).sum()), float((slope_north**2 - slope_east**2).sum())
    )
    return (math.degrees(double) / 2 + 90.0) % 180.0


def _sides_deg(dem: Dem) -> Array:
    """Directions of the sides of the narrowest rectangle around the area."""
    box = shapely.minimum_rotated_rectangle(dem.area_shape)
    corners = shapely.get_coordinates(box)
    sides = np.diff(corners[:3], axis=0)
    found: Array = np.degrees(np.arctan2(sides[:, 0], sides[:, 1])) % 180.0
    return found
