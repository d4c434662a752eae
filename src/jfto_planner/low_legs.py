"""Straight legs that would pass too near the ground."""

from __future__ import annotations

import numpy as np

from jfto_msgs_py.types import Array, Flags, GroundHeight

SPACING_M = 2.5
# What rounded corners and the vehicle's own error may take from a straight leg's height.
SPARE_M = 1.0
# Longer legs are not looked at one by one: no route of a survey has them, and checks come later.
LONGEST_M = 1500.0


def low_legs(
    waypoints_m: Array,
    lift_offs_m: Array,
    ground_height: GroundHeight,
    clearance_m: float,
    start_clearance_m: float,
) -> Flags:
    """Which legs pass lower than `clearance_m` above the ground, (W + A, W + A), symmetric.

    Nodes are waypoints (W, 3), then the places (A, 3) above the pads from which the first leg
    begins, ENU metres. A leg from there needs `start_clearance_m` until it is high enough once.
    """
    nodes = np.concatenate([waypoints_m, lift_offs_m])
    low = np.zeros((len(nodes), len(nodes)), dtype=np.bool_)
    count = len(waypoints_m)
    for i, node in enumerate(nodes):
        others = np.arange(min(i, count))
        step = nodes[others] - node
        size = np.linalg.norm(step, axis=1)
        others = others[size <= LONGEST_M]
        if not len(others):
            continue
        samples = int(np.ceil(size[size <= LONGEST_M].max() / SPACING_M)) + 2
        share = np.linspace(0.0, 1.0, samples)
        places = node + share[None, :, None] * (nodes[others] - node)[:, None, :]
        ground = ground_height(places[..., 0].ravel(), places[..., 1].ravel())
        above = places[..., 2] - ground.reshape(places.shape[:2])
        # A waypoint itself may be just as high as it must be.
        needed = np.full(above.shape, clearance_m + SPARE_M)
        needed[:, -1] = clearance_m
        if i >= count:
            highest = np.maximum.accumulate(above, axis=1)
            needed[highest < clearance_m + SPARE_M] = clearance_m
            needed[highest < clearance_m] = start_clearance_m
        else:
            needed[:, 0] = clearance_m
        low[i, others] = low[others, i] = (above < needed - 1e-9).any(axis=1)
    return low
