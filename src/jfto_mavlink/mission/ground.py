"""Legs over the ground: is there room below, and how high must the way home be?

The autopilot knows nothing of the terrain in frame 3: these checks are the only ones.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise

import numpy as np

from jfto_mavlink.errors import MissionError
from jfto_msgs_py.types import Array

# Ground height (ENU metres) at east and north positions, both of shape (K,).
Ground = Callable[[Array, Array], Array]

# Finer than the elevation models in use.
SAMPLE_M = 5.0


def check_clearance(uav: str, points_m: Array, ground: Ground, clearance_min_m: float) -> None:
    """Raise MissionError 301 if a straight leg between points (M, 3) comes too near the ground.

    The first point is above the pad after take-off, the others are waypoints. The message names the
    worst leg and by how much it misses.
    """
    worst, place = np.inf, 0
    for index, (start, end) in enumerate(pairwise(points_m)):
        samples = _between(start, end)
        clearance = float(np.min(samples[:, 2] - ground(samples[:, 0], samples[:, 1])))
        if clearance < worst:
            worst, place = clearance, index
    if worst < clearance_min_m:
        leg = "from take-off to waypoint 1" if place == 0 else f"from waypoint {place} to the next"
        raise MissionError(
            301,
            f"{uav}: the leg {leg} of its route passes {worst:.1f} m above the ground, at least "
            f"{clearance_min_m:g} m is wanted. Plan farther from the slope, or take off higher.",
        )


def return_height_m(pad_m: Array, last_m: Array, ground: Ground, clearance_m: float) -> float:
    """Height above the pad at which the straight way home clears all ground by `clearance_m`."""
    samples = _between(np.array([*last_m[:2], 0.0]), np.array([*pad_m[:2], 0.0]))
    return float(np.max(ground(samples[:, 0], samples[:, 1])) + clearance_m - pad_m[2])


def _between(start: Array, end: Array) -> Array:
    steps = max(int(np.linalg.norm(end - start) / SAMPLE_M), 1)
    return start + (end - start) * np.linspace(0.0, 1.0, steps + 1)[:, None]
