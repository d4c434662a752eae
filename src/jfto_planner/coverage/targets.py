"""Points on the ground for the centres of photos: a grid along the surface, and what it leaves."""

from __future__ import annotations

import math

import numpy as np
from scipy import ndimage

from jfto_msgs_py.errors import InfeasibleError
from jfto_msgs_py.types import Array
from jfto_planner.coverage.certificate import CoverageCertificate
from jfto_world.terrain import CubicSurface

_SAMPLES_PER_SPACING = 12


def surface_lattice(
    surface: CubicSurface,
    size_m: tuple[float, float],
    spacing_m: tuple[float, float],
    max_points: int,
) -> Array:
    """Points (W, 2), x and y, spaced at most `spacing_m` apart measured along the surface.

    Rows run along x. The arc of every south-north profile is cut into equal parts, as many as the
    longest needs: so rows bunch on steep ground. Each row, a curve on the surface, is then cut
    into equal arcs of its own. Rows come from south to north, each from west to east.

    Raises InfeasibleError beyond `max_points`.
    """
    flat_count = math.ceil(size_m[0] / spacing_m[0]) * math.ceil(size_m[1] / spacing_m[1])
    check_count(flat_count, max_points)
    x = _samples(size_m[0], spacing_m[0])
    y = _samples(size_m[1], spacing_m[1])
    grid_x, grid_y = np.meshgrid(x, y)
    z = surface.height_and_gradient(grid_x, grid_y)[0]

    arcs = _cumulated(np.hypot(np.diff(y)[:, None], np.diff(z, axis=0)))
    rows = math.ceil(arcs[-1].max() / spacing_m[1] - 1e-9)
    row_y = np.stack([_cut(arcs[:, k], y, rows) for k in range(len(x))], axis=1)

    points = []
    for curve_y in row_y:
        curve_z = surface.height_and_gradient(x, curve_y)[0]
        steps = np.sqrt(np.diff(x) ** 2 + np.diff(curve_y) ** 2 + np.diff(curve_z) ** 2)
        arc = _cumulated(steps[:, None])[:, 0]
        row_x = _cut(arc, x, math.ceil(arc[-1] / spacing_m[0] - 1e-9))
        points.append(np.stack([row_x, np.interp(row_x, x, curve_y)], axis=-1))
        check_count(sum(map(len, points)), max_points)
    return np.concatenate(points)


def _samples(length_m: float, spacing_m: float) -> Array:
    count = max(64, math.ceil(_SAMPLES_PER_SPACING * length_m / spacing_m))
    return np.linspace(-length_m / 2, length_m / 2, count + 1)


def _cumulated(steps: Array) -> Array:
    return np.concatenate([np.zeros((1, steps.shape[1])), np.cumsum(steps, axis=0)])


def _cut(arc: Array, coordinate: Array, parts: int) -> Array:
    """Coordinates of the middles of `parts` equal parts of a curve."""
    return np.interp((np.arange(parts) + 0.5) / parts * arc[-1], arc, coordinate)


def check_count(count: int, max_points: int) -> None:
    """Raise InfeasibleError where an area takes more waypoints than are allowed."""
    if count > max_points:
        raise InfeasibleError(
            f"The coverage needs more than {max_points} waypoints (at least {count}).",
            cures=(
                "a larger coverage.distance_m or coverage.gsd_cm",
                "smaller coverage.overlap_h and coverage.overlap_v",
                "a smaller area (terrain.size_m, area.file)",
            ),
        )


def gap_centres(
    certificate: CoverageCertificate, window_m: float, most: int, may_stay: float
) -> Array:
    """Points (K, 2), x and y, around which most ground is unseen, the worst first, K ≤ `most`.

    Greedy: the square window of side `window_m` with the most unseen samples is taken, its samples
    count as seen, and so on until at most the share `may_stay` of the area's is left.
    """
    x, y = certificate.x_m, certificate.y_m
    unseen = certificate.inside & (certificate.views == 0)
    left = may_stay * int(certificate.inside.sum())
    size = (_odd(window_m / (y[1] - y[0])), _odd(window_m / (x[1] - x[0])))
    centres: list[tuple[float, float]] = []
    while unseen.sum() > left and len(centres) < most:
        count = ndimage.uniform_filter(unseen.astype(np.float64), size, mode="constant")
        # The window's unseen samples may lie in a corner of it: aim at their middle.
        row, column = np.unravel_index(int(np.argmax(np.round(count, 9))), count.shape)
        window = (
            slice(max(0, row - size[0] // 2), row + size[0] // 2 + 1),
            slice(max(0, column - size[1] // 2), column + size[1] // 2 + 1),
        )
        rows, columns = np.nonzero(unseen[window])
        centres.append(
            (
                float(x[window[1]][columns].mean()),
                float(y[window[0]][rows].mean()),
            )
        )
        unseen[window] = False
    return np.array(centres).reshape(-1, 2)


def _odd(samples: float) -> int:
    return max(1, int(samples) | 1)
