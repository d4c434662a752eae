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
) -> tuple[Array, ...]:
    """Lines of (K, 3) points from `start_m` (3,) to above `pad_m` (3,), rounded as in a plan file.

    Each climbs straight up where it must, goes straight to the pad, sinking where the ground lets
    it, or level, and comes straight down to where landing begins. It keeps `clearance_m` above
    ground, or what it has where it begins. There are `layers` of either kind, `layer_m` apart.
    """
    start, pad = np.asarray(start_m, dtype=np.float64), np.asarray(pad_m, dtype=np.float64)
    above = pad + np.array([0.0, 0.0, LAND_FROM_M])
    if np.hypot(*(start - pad)[:2]) <= COLUMN_M:
        return (_line(start, above) if start[2] > above[2] else _line(start),)
    share, floor = _floor(start, pad, ground, clearance_m)
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
        line = _line(start, np.array([*start[:2], begin]), np.array([*pad[:2], end]), above)
        lines.setdefault(line.tobytes(), line)
    return tuple(lines.values())


def _floor(
    start: Array, pad: Array, ground: GroundHeight, clearance_m: float
) -> tuple[Array, Array]:
    """Shares (S,) of the way from start to pad, and how high one must be there."""
    steps = max(2, int(np.ceil(np.hypot(*(pad - start)[:2]) / SAMPLE_M)))
    share = np.linspace(0.0, 1.0, steps + 1)
    east, north = (start[k] + share * (pad[k] - start[k]) for k in (0, 1))
    return share, ground(east, north) + clearance_m + SPARE_M


def _line(*points: Array) -> Array:
    """Points as a plan file holds them, without those that repeat the one before."""
    kept = [np.array(rounded_record(points[0]))]
    for point in points[1:]:
        plain = np.array(rounded_record(point))
        if np.linalg.norm(plain - kept[-1]) > 1e-3:
            kept.append(plain)
    return np.array(kept)
