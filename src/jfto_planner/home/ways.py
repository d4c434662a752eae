"""Lines that a UAV could take from its last waypoint to its pad, over the ground in between."""

from __future__ import annotations

import numpy as np

from jfto_msgs_py.plan_file import rounded_record
from jfto_msgs_py.types import Array, GroundHeight
from jfto_world.motion.landing import LAND_FROM_M

# So near its pad a UAV only goes up and down; finer than the elevation models in use.
COLUMN_M, SAMPLE_M = 3.0, 1.0
# Beyond the clearance: the height lost to corners, and what the vehicle strays.
SPARE_M = 0.5


def lines_home(
    start_m: Array,
    pad_m: Array,
    ground: GroundHeight,
    clearance_m: float,
    layer_m: float,
    layers: int,
    round_m: Array | None = None,
) -> tuple[Array, ...]:
    """Lines of (K, 3) points from `start_m` (3,) to above `pad_m` (3,), rounded as in a plan file.

    Each climbs straight up where it must, goes straight to the pad, sinking where the ground lets
    it, or level, and comes straight down to where landing begins. It keeps `clearance_m` above
    ground, or what it has where it begins. There are `layers` of either kind, `layer_m` apart.
    In plan view they pass `round_m` (P, 2), round no-fly zones.
    """
    start, pad = np.asarray(start_m, dtype=np.float64), np.asarray(pad_m, dtype=np.float64)
    above = pad + np.array([0.0, 0.0, LAND_FROM_M])
    if np.hypot(*(start - pad)[:2]) <= COLUMN_M:
        return (_line(start, above) if start[2] > above[2] else _line(start),)
    inner = np.zeros((0, 2)) if round_m is None else round_m
    flat = np.concatenate([start[None, :2], inner, pad[None, :2]])
    share, floor, at = _floor(flat, ground, clearance_m)
    over = max(float(floor[-1]), above[2])
    straight = (1.0 - share) * start[2] + share * over
    lift = max(0.0, float(np.max(floor - straight)))
    level = max(float(np.max(floor)), start[2], over)
    # Where the start is low over a slope, it goes up there first.
    heights = [
        (start[2] + lift + k * layer_m, over + lift + k * layer_m) for k in range(layers)
    ] + [(level + k * layer_m, level + k * layer_m) for k in range(layers)]
    lines: dict[bytes, Array] = {}
    for begin, end in heights:
        passed = np.column_stack([flat, (1.0 - at) * begin + at * end])
        line = _line(start, *passed, above)
        lines.setdefault(line.tobytes(), line)
    return tuple(lines.values())


def _floor(flat: Array, ground: GroundHeight, clearance_m: float) -> tuple[Array, Array, Array]:
    """Shares (S,) of a way (P, 2) in plan view, the least height there, its points' shares."""
    sizes = np.hypot(*np.diff(flat, axis=0).T)
    at = np.concatenate([[0.0], np.cumsum(sizes)]) / sizes.sum()
    at[-1] = 1.0
    shares, floors = [np.zeros(0)], [np.zeros(0)]
    for k, size in enumerate(sizes):
        share = np.linspace(0.0, 1.0, max(2, int(np.ceil(size / SAMPLE_M))) + 1)
        east, north = (
            flat[k, axis] + share * (flat[k + 1, axis] - flat[k, axis]) for axis in (0, 1)
        )
        shares.append(at[k] + share * (at[k + 1] - at[k]))
        floors.append(ground(east, north) + clearance_m + SPARE_M)
    return np.concatenate(shares), np.concatenate(floors), at


def _line(*points: Array) -> Array:
    """Points as a plan file holds them, without those that repeat the one before."""
    kept = [np.array(rounded_record(points[0]))]
    for point in points[1:]:
        plain = np.array(rounded_record(point))
        if np.linalg.norm(plain - kept[-1]) > 1e-3:
            kept.append(plain)
    return np.array(kept)
