"""A UAV's battery, and the power that flying takes of it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from jfto_msgs_py.records.fields import Range

Positive = Annotated[float, Range(0.0, above=True)]


@dataclass(frozen=True)
class Battery:
    """Capacity and powers; `reserve_percent` of the capacity is left when the UAV is down again.

    `hover_power_w` is taken while it stands in the air, `cruise_power_w` while it is under way at
    its planned speed in calm air.
    """

    capacity_wh: Positive
    hover_power_w: Positive
    cruise_power_w: Positive
    reserve_percent: Annotated[float, Range(0.0, 90.0)] = 20.0

    @property
    def usable_wh(self) -> float:
        """What a flight may take of a full battery."""
        return self.capacity_wh * (1.0 - self.reserve_percent / 100.0)
