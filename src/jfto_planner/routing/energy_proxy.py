"""The kernels' stand-in for the energy floor, in array code."""

from __future__ import annotations

import numpy as np

from jfto_planner.routing.problem import Array
from jfto_world.radio import pairwise_distances


def energy_proxy(positions_m: Array, slot_s: float, k_min: int, exponent: float) -> Array:
    """Time integral of (distance / 1 km)^exponent to the farthest UAV that one must reach, (A,).

    Those are a UAV's k_min nearest (at least one) and all that count it among theirs.
    `positions_m` is (N + 1, A, 3).
    """
    uavs = positions_m.shape[1]
    if uavs == 1:
        return np.zeros(1)
    distance = pairwise_distances(positions_m) * 1e-3
    distance[:, np.arange(uavs), np.arange(uavs)] = np.inf
    kth = np.sort(distance, axis=-1)[:, :, max(k_min, 1) - 1]
    mutual = distance <= np.maximum(kth[:, :, None], kth[:, None, :])
    need = np.where(mutual, distance, 0.0).max(axis=-1)
    return (need[1:] ** exponent).sum(axis=0) * slot_s
