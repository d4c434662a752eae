"""Compiled loops over a bicubic B-spline: its value, and where a ray first meets it.

Over one cell of the grid the height of a ray above the surface is a polynomial of degree 6 in the
distance along it. Its Bernstein coefficients bound it from below (convex-hull property): a cell
whose coefficients are all positive is passed, others are halved (de Casteljau) until the first
root is bracketed to within `_RESOLUTION` of the cell. So no step length exists by which a grazing
ray could slip past. See Sederberg and Nishita, Curve intersection using Bezier clipping,
Computer-Aided Design 22 (1990).
"""

from __future__ import annotations

import math

import numpy as np

from jfto_msgs_py.types import Array
from jfto_world.compiled import inner, kernel

_DEGREE = 6
_RESOLUTION = 2.0**-28
# A piece of a polynomial on the stack: its coefficients, where it begins, and how wide it is.
_BEGIN, _WIDTH = _DEGREE + 1, _DEGREE + 2
_STACK, _PIECE = 32, _DEGREE + 3


def _bernstein_from_samples() -> Array:
    # Values at 7 equally spaced points -> Bernstein coefficients of the polynomial through them.
    t = np.linspace(0.0, 1.0, _DEGREE + 1)
    basis = [math.comb(_DEGREE, k) * t**k * (1 - t) ** (_DEGREE - k) for k in range(_DEGREE + 1)]
    return np.linalg.inv(np.stack(basis, axis=1))


_TO_BERNSTEIN = _bernstein_from_samples()


@inner
def evaluate(coefficients: Array, u: float, v: float) -> tuple[float, float, float]:
    """Height and its slopes per node at node coordinates (u along columns, v along rows)."""
    columns = coefficients.shape[1] - 2
    rows = coefficients.shape[0] - 2
    u = min(max(u, 0.0), columns - 1.0)
    v = min(max(v, 0.0), rows - 1.0)
    j = min(math.floor(u), columns - 2)
    i = min(math.floor(v), rows - 2)
    a = u - j
    b = v - i
    a1, b1 = 1.0 - a, 1.0 - b
    u0, u3 = a1 * a1 * a1 / 6, a * a * a / 6
    u1 = (3 * a * a * a - 6 * a * a + 4) / 6
    u2 = 1.0 - u0 - u1 - u3
    v0, v3 = b1 * b1 * b1 / 6, b * b * b / 6
    v1 = (3 * b * b * b - 6 * b * b + 4) / 6
    v2 = 1.0 - v0 - v1 - v3
    du0, du3 = -a1 * a1 / 2, a * a / 2
    du1 = (3 * a * a - 4 * a) / 2
    du2 = -du0 - du1 - du3
    dv0, dv3 = -b1 * b1 / 2, b * b / 2
    dv1 = (3 * b * b - 4 * b) / 2
    dv2 = -dv0 - dv1 - dv3
    height = along_u = along_v = 0.0
    for k in range(4):
        c0 = coefficients[i + k, j]
        c1 = coefficients[i + k, j + 1]
        c2 = coefficients[i + k, j + 2]
        c3 = coefficients[i + k, j + 3]
        row = u0 * c0 + u1 * c1 + u2 * c2 + u3 * c3
        weight = v0 if k == 0 else v1 if k == 1 else v2 if k == 2 else v3
        slope = dv0 if k == 0 else dv1 if k == 1 else dv2 if k == 2 else dv3
        height += weight * row
        along_u += weight * (du0 * c0 + du1 * c1 + du2 * c2 + du3 * c3)
        along_v += slope * row
    return height, along_u, along_v


@kernel
def evaluate_all(coefficients: Array, u: Array, v: Array, result: Array) -> None:
    """Fill `result` (3, K) with heights and slopes per node at K node coordinates."""
    for k in range(u.size):
        result[0, k], result[1, k], result[2, k] = evaluate(coefficients, u[k], v[k])


@inner
def _first_root(stack: Array, left: Array) -> float:
    """First t in [0, 1] at which a polynomial in Bernstein form is ≤ 0; inf if none.

    `stack` holds the polynomial as its first piece and is overwritten, as is `left` (7,).
    """
    depth = 0
    stack[0, _BEGIN], stack[0, _WIDTH] = 0.0, 1.0
    while depth >= 0:
        row = stack[depth]
        start, width = row[_BEGIN], row[_WIDTH]
        if row[0] <= 0.0:
            return start
        lowest = row[1]
        for k in range(2, _DEGREE + 1):
            lowest = min(lowest, row[k])
        if lowest > 0.0:
            depth -= 1
            continue
        if width <= _RESOLUTION:
            # Either a root, or a dip of the hull too shallow to resolve: a graze is a hit.
            return start
        for level in range(_DEGREE + 1):
            left[level] = row[0]
            for k in range(_DEGREE - level):
                row[k] = 0.5 * (row[k] + row[k + 1])
        # `row` now holds the right half; the left half goes on top of the stack.
        row[_BEGIN], row[_WIDTH] = start + 0.5 * width, 0.5 * width
        depth += 1
        for k in range(_DEGREE + 1):
            stack[depth, k] = left[k]
        stack[depth, _BEGIN], stack[depth, _WIDTH] = start, 0.5 * width
    return math.inf


@inner
def _clip(
    position: float, step: float, last: float, near: float, far: float
) -> tuple[float, float]:
    """Part of [near, far] in which 0 ≤ position + step t ≤ last; empty where near > far."""
    if step == 0.0:
        if position < 0.0 or position > last:
            return 1.0, 0.0
        return near, far
    low, high = -position / step, (last - position) / step
    if low > high:
        low, high = high, low
    return max(near, low), min(far, high)


@inner
def _clip_height(
    z: float, dz: float, floor: float, ceiling: float, near: float, far: float
) -> tuple[float, float]:
    """Part of [near, far] in which a ray is below `ceiling` and, falling, above `floor`."""
    if dz < 0.0:
        return max(near, (ceiling - z) / dz), min(far, max((floor - z) / dz, near))
    if dz > 0.0:
        return near, min(far, (ceiling - z) / dz)
    return near, far


@inner
def _crossing(position: float, step: float, cell: int) -> float:
    """Distance at which a ray leaves a cell of unit width; inf where it never does."""
    if step > 0.0:
        return (cell + 1 - position) / step
    if step < 0.0:
        return (cell - position) / step
    return math.inf


@kernel
def first_hits(
    coefficients: Array,
    highest: Array,
    grid: Array,
    rays: Array,
    room: Array,
    result: Array,
) -> None:
    """Fill `result` (K,) with the distance of each ray's first point on or below the surface.

    `grid` holds x0, y0, step_x, step_y and bounds of the whole surface from below and above;
    `highest` a bound from above for each cell; `rays` (K, 7) origins, unit vectors and ranges;
    `room` is `room_for_hits()`.
    """
    rows, columns = highest.shape
    floor, ceiling = grid[4], grid[5]
    stack, left, gap = room[:_STACK], room[_STACK], room[_STACK + 1]
    for ray in range(len(rays)):
        result[ray] = math.inf
        u, v = (rays[ray, 0] - grid[0]) / grid[2], (rays[ray, 1] - grid[1]) / grid[3]
        du, dv = rays[ray, 3] / grid[2], rays[ray, 4] / grid[3]
        z, dz = rays[ray, 2], rays[ray, 5]
        near, far = _clip(u, du, float(columns), 0.0, rays[ray, 6])
        near, far = _clip(v, dv, float(rows), near, far)
        near, far = _clip_height(z, dz, floor, ceiling, near, far)
        if near > far:
            continue
        j = min(max(math.floor(u + du * near), 0), columns - 1)
        i = min(max(math.floor(v + dv * near), 0), rows - 1)
        while near <= far:
            leave_u, leave_v = _crossing(u, du, j), _crossing(v, dv, i)
            end = max(near, min(far, leave_u, leave_v))
            if min(z + dz * near, z + dz * end) <= highest[i, j]:
                for k in range(_DEGREE + 1):
                    t = near + (end - near) * k / _DEGREE
                    gap[k] = z + dz * t - evaluate(coefficients, u + du * t, v + dv * t)[0]
                for k in range(_DEGREE + 1):
                    stack[0, k] = 0.0
                    for m in range(_DEGREE + 1):
                        stack[0, k] += _TO_BERNSTEIN[k, m] * gap[m]
                root = _first_root(stack, left)
                if root <= 1.0:
                    result[ray] = near + root * (end - near)
                    break
            if end >= far:
                break
            near = end
            if leave_u <= leave_v:
                j += 1 if du > 0.0 else -1
            if leave_v <= leave_u:
                i += 1 if dv > 0.0 else -1
            if i < 0 or j < 0 or i >= rows or j >= columns:
                break


def room_for_hits() -> Array:
    """Room for `first_hits` to work in: a stack of pieces and two rows."""
    return np.empty((_STACK + 2, _PIECE))
