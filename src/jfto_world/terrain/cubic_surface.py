"""A smooth surface through a regular grid of heights, the bicubic spline; where rays meet it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from jfto_msgs_py.types import Array
from jfto_world.terrain.kernels import evaluate_all, first_hits, room_for_hits

# The spline filter forgets its edge by a factor 0.27 a node: 24 nodes away by 1e-14.
_PAD = 24


@dataclass(frozen=True)
class CubicSurface:
    """Interpolating bicubic B-spline, twice continuously differentiable.

    Node (i, j) lies at x = x0 + j * step_x, y = y0 + i * step_y. `coefficients` has shape
    (ny + 2, nx + 2). Steps may be negative (rasters run southwards).
    """

    coefficients: Array
    shape: tuple[int, int]
    x0: float
    y0: float
    step_x: float
    step_y: float

    @classmethod
    def through(
        cls, heights: Array, x0: float, y0: float, step_x: float, step_y: float
    ) -> CubicSurface:
        """Surface through `heights` of shape (ny, nx), both at least 2, all finite.

        Beyond the grid the heights are continued by odd reflection, so that the slope at its edge
        is that of the data.
        """
        # Here and not above: it takes longer to load than a node that died may be away.
        from scipy import ndimage

        grid = np.asarray(heights, dtype=np.float64)
        padded = np.pad(grid, _PAD, mode="reflect", reflect_type="odd")
        filtered = ndimage.spline_filter(padded, order=3, mode="mirror")
        keep = slice(_PAD - 1, 1 - _PAD)  # one coefficient beyond the grid on each side
        rows, columns = grid.shape
        return cls(
            np.ascontiguousarray(filtered[keep, keep]), (rows, columns), x0, y0, step_x, step_y
        )

    def transposed(self) -> CubicSurface:
        """The same surface with x and y exchanged."""
        return CubicSurface(
            np.ascontiguousarray(self.coefficients.T),
            (self.shape[1], self.shape[0]),
            self.y0,
            self.x0,
            self.step_y,
            self.step_x,
        )

    def contains(self, x: Array, y: Array) -> NDArray[np.bool_]:
        """Whether points lie within the grid's nodes."""
        u, v = (x - self.x0) / self.step_x, (y - self.y0) / self.step_y
        rows, columns = self.shape
        slack = 1e-9
        return (u >= -slack) & (u <= columns - 1 + slack) & (v >= -slack) & (v <= rows - 1 + slack)

    def height_and_gradient(self, x: Array, y: Array) -> tuple[Array, Array, Array]:
        """Heights and slopes dz/dx and dz/dy at points of one shape.

        Points outside take the value at the nearest edge; ask `contains` first.
        """
        u = np.asarray((x - self.x0) / self.step_x, dtype=np.float64)
        v = np.asarray((y - self.y0) / self.step_y, dtype=np.float64)
        result = np.empty((3, u.size))
        evaluate_all(self.coefficients, u.ravel(), v.ravel(), result)
        height, along_u, along_v = (row.reshape(u.shape) for row in result)
        return height, along_u / self.step_x, along_v / self.step_y


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
        np.column_stack([origin_m, unit, max_range_m]).astype(np.float64, order="C"),
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
