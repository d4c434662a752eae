"""Room that a path leaves to the figures of a fence, in metres on a plane."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from jfto_msgs_py.types import Array, Flags

# Finer than what a vehicle strays from its path.
SAMPLE_M = 2.0


def polygon_room_m(path: Array, corners: Array, *, inclusion: bool) -> float:
    """How near a path (M, 2) comes to the edge of a polygon (V, 2) that it must stay in, or out of.

    Negative where it is on the wrong side: how far beyond the edge it gets.
    """
    samples = sampled(path)
    edges = np.roll(corners, -1, axis=0)
    wrong = inside(samples, corners) != inclusion
    if wrong.any():
        return -max(float(_away(samples[wrong], corners, edges).min(axis=1).max()), 1e-6)
    legs = (path[:-1], path[1:])
    if len(path) > 1 and _cross(*legs, corners, edges).any():
        return -1e-6
    room = float(_away(path, corners, edges).min())
    return room if len(path) == 1 else min(room, float(_away(corners, *legs).min()))


def circle_room_m(path: Array, center: Array, radius_m: float, *, inclusion: bool) -> float:
    """The same for a circle."""
    if inclusion:
        return radius_m - float(np.hypot(*(path - center).T).max())
    start, end = (path, path) if len(path) == 1 else (path[:-1], path[1:])
    return float(_away(center[None], start, end).min()) - radius_m


def sampled(path: Array, step_m: float = SAMPLE_M) -> Array:
    """Points (N, D) along a path (M, D), at most `step_m` apart."""
    parts = [path[:1]]
    for start, end in pairwise(path):
        count = max(int(np.ceil(np.linalg.norm(end - start) / step_m)), 1)
        parts.append(start + (end - start) * (np.arange(1, count + 1) / count)[:, None])
    return np.vstack(parts)


def inside(points: Array, corners: Array) -> Flags:
    """Which points (N, 2) lie inside a polygon (V, 2), by the even-odd rule as the autopilot's."""
    before = np.roll(corners, 1, axis=0)
    x, y = points[:, :1], points[:, 1:]
    spans = (corners[:, 1] > y) != (before[:, 1] > y)
    rise = np.where(corners[:, 1] == before[:, 1], 1.0, before[:, 1] - corners[:, 1])
    at = corners[:, 0] + (y - corners[:, 1]) * (before[:, 0] - corners[:, 0]) / rise
    return np.asarray((spans & (x < at)).sum(axis=1) % 2 == 1)


def _away(points: Array, start: Array, end: Array) -> Array:
    """Distance of each point (N, 2) from each segment (S, 2) to (S, 2): (N, S)."""
    along = end - start
    length2 = np.maximum((along**2).sum(axis=1), 1e-12)
    offset = points[:, None] - start[None]
    share = np.clip((offset * along).sum(axis=2) / length2, 0.0, 1.0)
    return np.asarray(np.linalg.norm(offset - share[..., None] * along, axis=2))


def _cross(a: Array, b: Array, c: Array, d: Array) -> Flags:
    """Which segments a–b (N, 2) properly cross which c–d (S, 2): (N, S)."""

    def side(p: Array, q: Array, r: Array) -> Array:
        return np.asarray(
            np.sign(
                (q[..., 0] - p[..., 0]) * (r[..., 1] - p[..., 1])
                - (q[..., 1] - p[..., 1]) * (r[..., 0] - p[..., 0])
            )
        )

    a, b = a[:, None], b[:, None]
    c, d = c[None], d[None]
    return np.asarray((side(a, b, c) * side(a, b, d) < 0) & (side(c, d, a) * side(c, d, b) < 0))
