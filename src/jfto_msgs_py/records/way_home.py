"""The way home: what a UAV flies once the whole fleet is done, as it stands in a plan."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import numpy as np

from jfto_msgs_py.records.fields import Range
from jfto_msgs_py.types import Array

Seconds = Annotated[float, Range(0.0)]


@dataclass(frozen=True)
class WayHome:
    """From where a UAV holds after its last waypoint to the ground at its pad.

    It holds for `hold_s`, whole seconds counted from its arrival at its last waypoint, or from the
    horizon where flights are streamed curves: the autopilot flies all ways home by itself.
    `points_m` (K, 3), ENU, begin there and end above the pad; they are reached at `reached_s` (K,),
    seconds from lift-off, the first being when it leaves. From the last of them it comes straight
    down and stands at `landed_s`.
    """

    hold_s: Seconds
    points_m: tuple[tuple[float, float, float], ...]
    reached_s: tuple[Seconds, ...]
    landed_s: Seconds

    @property
    def leave_s(self) -> float:
        """When it leaves, seconds from lift-off."""
        return self.reached_s[0]

    @property
    def line_m(self) -> Array:
        """Its points (K, 3)."""
        return np.array(self.points_m)
