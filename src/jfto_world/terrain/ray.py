"""Where rays first meet a bicubic surface."""

from __future__ import annotations

import numpy as np

from jfto_msgs_py.types import Array
from jfto_world.terrain.cubic_surface import CubicSurface
from jfto_world.terrain.kernels import first_hits, room_for_hits


def first_hit(
    surface: CubicSurface, highest: Array, origin_m: Array, unit: Array, max_range_m: Array
) -> Array:
    """Distance along each ray to its first point on or below the surface; inf where it has none.

    `origin_m` and `unit` (unit vectors) have shape (K, 3), `max_range_m` (K,). `highest` is
    `cell_ceilings(surface)`. A ray sees the surface only above the grid; one that starts on or
    below the surface hits at 0.
    """
    result = np.empty(len(origin_m))
    grid = [surface.x0, surface.y0, surface.step_x, surface.step_y]
    first_hits(
        surface.coefficients,
        highest,
        np.array([*grid, surface.coefficients.min() - 1.0, highest.max()]),
        np.ascontiguousarray(origin_m, dtype=np.float64),
        np.ascontiguousarray(unit, dtype=np.float64),
        np.ascontiguousarray(max_range_m, dtype=np.float64),
        room_for_hits(),
        result,
    )
    return result


def cell_ceilings(surface: CubicSurface) -> Array:
    """A bound from above of the surface in each cell, shape (ny - 1, nx - 1).

    The greatest of the 16 coefficients that shape the cell (B-splines are convex combinations).
    """
    windows = np.lib.stride_tricks.sliding_window_view(surface.coefficients, (4, 4))
    return np.ascontiguousarray(windows.max(axis=(-2, -1)))
