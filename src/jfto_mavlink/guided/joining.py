"""From where a vehicle is onto its trajectory: an offset that fades out smoothly."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from jfto_mavlink.guided.reference import Reference
from jfto_msgs_py.types import Array

# What joining may add to the trajectory's own speed and acceleration.
JOIN_MPS = 2.0
JOIN_MPS2 = 1.0
JOIN_UP_MPS = 0.7
JOIN_UP_MPS2 = 0.4
LEAST_S = 1.0
# Of a quintic from rest to rest over unit length and time: greatest speed and acceleration.
PEAK_SPEED, PEAK_ACCELERATION = 1.875, 5.7736


@dataclass(frozen=True, eq=False)
class Joining:
    """Fades a position offset out with the quintic from rest to rest, beginning at `since_s`."""

    since_s: float
    offset_m: Array
    duration_s: float

    @staticmethod
    def begin(now_s: float, offset_m: Array) -> Joining:
        """Fade out an offset (3,) as fast as the added speed and acceleration allow."""
        level, height = float(np.hypot(offset_m[0], offset_m[1])), float(abs(offset_m[2]))
        duration_s = max(
            LEAST_S,
            PEAK_SPEED * level / JOIN_MPS,
            math.sqrt(PEAK_ACCELERATION * level / JOIN_MPS2),
            PEAK_SPEED * height / JOIN_UP_MPS,
            math.sqrt(PEAK_ACCELERATION * height / JOIN_UP_MPS2),
        )
        return Joining(now_s, offset_m, duration_s)

    def applied(self, reference: Reference, now_s: float) -> Reference:
        """The reference (3,) with what is left of the offset."""
        u = min(max((now_s - self.since_s) / self.duration_s, 0.0), 1.0)
        left = 1.0 - u**3 * (10 - 15 * u + 6 * u**2)
        slope = -30 * u**2 * (1 - u) ** 2 / self.duration_s
        bend = -60 * u * (1 - u) * (1 - 2 * u) / self.duration_s**2
        return Reference(
            reference.position_m + left * self.offset_m,
            reference.velocity_mps + slope * self.offset_m,
            reference.acceleration_mps2 + bend * self.offset_m,
        )

    def over(self, now_s: float) -> bool:
        """Whether nothing of the offset is left."""
        return now_s >= self.since_s + self.duration_s
