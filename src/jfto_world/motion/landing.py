"""The last metres of a flight: straight down onto the pad, at the autopilot's landing speed."""

from __future__ import annotations

import numpy as np

from jfto_msgs_py.types import Array

# LAND_SPEED of the autopilot as missions set it, and what it takes to notice the ground, measured.
LAND_MPS = 0.5
TOUCHDOWN_S = 1.0
# Ways home end so high above the pad: LAND_ALT_LOW, from which the autopilot sinks slowly.
LAND_FROM_M = 10.0


def landing_s(height_m: float) -> float:
    """Seconds from a hover above the pad until the vehicle stands on it; 0 on the ground."""
    return height_m / LAND_MPS + TOUCHDOWN_S if height_m > 0 else 0.0


def landing_places(above_m: Array, pad_up_m: float, since_s: Array) -> Array:
    """Places (T, 3) at times since a hover at `above_m` (3,); on the pad once it is reached."""
    places = np.tile(np.asarray(above_m, dtype=np.float64), (len(since_s), 1))
    sunk_m = LAND_MPS * np.clip(since_s, 0.0, None)
    places[:, 2] = np.maximum(places[:, 2] - sunk_m, min(pad_up_m, float(above_m[2])))
    return places
