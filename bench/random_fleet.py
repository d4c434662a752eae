"""Fleets that wander over a square, to measure on."""

from __future__ import annotations

import numpy as np


def wandering_fleet(uavs: int, slots: int, seed: int = 0, density_per_km2: float = 2.0):
    """Positions (slots + 1, A, 3) in metres and P_a,max (A,) in watts, 27 to 30 dBm.

    UAVs fly straight at 10 m/s for 3 s slots and bounce off the edges of a square that holds
    `density_per_km2` of them: 2 km × 2 km for 8.
    """
    rng = np.random.default_rng(seed)
    side_m = 1000 * np.sqrt(uavs / density_per_km2)
    start = rng.uniform(0, side_m, (uavs, 2))
    heading = rng.uniform(0, 2 * np.pi, uavs)
    step = 30.0 * np.stack([np.cos(heading), np.sin(heading)], axis=1)
    ahead = start + np.arange(slots + 1)[:, None, None] * step
    folded = side_m - np.abs(ahead % (2 * side_m) - side_m)
    height = np.broadcast_to(rng.uniform(0, 200, (uavs, 1)), (slots + 1, uavs, 1))
    p_max_w = 10 ** (rng.uniform(27, 30, uavs) / 10) / 1000
    return np.concatenate([folded, height], axis=2), p_max_w
