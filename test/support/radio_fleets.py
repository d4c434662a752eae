"""Fleets of any shape over air in which 1 W reaches 1000 m."""

from __future__ import annotations

import numpy as np
from hypothesis import strategies as st

from jfto_world.radio import LogDistanceChannel

CHANNEL = LogDistanceChannel(1e-4)
SENSITIVITY_W = 1e-10


def power_for(distance_m):
    return CHANNEL.required_power(np.asarray(distance_m), SENSITIVITY_W)


@st.composite
def fleets(draw):
    """Positions (3, A, 3) of spread, clustered or grid-like fleets, unequal caps, K_min and δ."""
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    uavs = draw(st.integers(1, 14))
    spread = draw(st.sampled_from([200.0, 900.0, 1800.0, 4000.0]))
    kind = draw(st.sampled_from(["uniform", "clusters", "grid"]))
    positions = rng.uniform(0, spread, (3, uavs, 3)) * [1, 1, 0.1]
    if kind == "clusters":
        positions = positions * 0.1 + rng.integers(0, 2, (3, uavs, 1)) * [spread, 0, 0]
    elif kind == "grid":
        positions = rng.integers(0, 4, (3, uavs, 3)) * spread / 4
    caps_w = power_for(rng.uniform(600, 1400, uavs))
    k_min = draw(st.integers(0, min(3, uavs - 1)))
    return positions, caps_w, k_min, draw(st.integers(0, 3))
