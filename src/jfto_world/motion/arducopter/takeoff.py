"""The climb from the pad that NAV_TAKEOFF flies before the first leg.

Measured on ArduCopter 4.5 from 20, 40 and 60 m: the item is done 4.0 s + height / climb speed
after the mission's start, and the vehicle lifts off 1.8 s after it. Times here start at lift-off.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

SPOOL_UP_S = 1.8
_OVERHEAD_S = 2.2


def takeoff_s(height_m: float, climb_mps: float) -> float:
    """Seconds from lift-off until the first leg begins; 0 for no height."""
    return 0.0 if height_m <= 0 else _OVERHEAD_S + height_m / climb_mps


def takeoff_height_m(height_m: float, climb_mps: float, times_s: Array) -> Array:
    """Height above the pad at times since lift-off, (T,): a trapezoid of climb speed."""
    total = takeoff_s(height_m, climb_mps)
    times = np.asarray(times_s, dtype=np.float64)
    if total == 0:
        return np.zeros_like(times)
    ramp = min(_OVERHEAD_S, 0.5 * total)
    speed = height_m / (total - ramp)
    now = np.clip(times, 0.0, total)
    rising = np.minimum(now, ramp) ** 2 / (2.0 * ramp)
    cruise = np.clip(now - ramp, 0.0, total - 2.0 * ramp)
    late = np.clip(now - (total - ramp), 0.0, ramp)
    return speed * (rising + cruise + late - late**2 / (2.0 * ramp))
