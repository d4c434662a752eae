"""How a waypoint was passed, from the autopilot's reports in flight to the report after it."""

from __future__ import annotations

import math
from dataclasses import dataclass

# A waypoint passed at this distance or less counts as visited.
VISITED_M = 2.0


@dataclass(frozen=True)
class Passage:
    """One waypoint of one UAV; times in s after lift-off.

    `reached_s` is None until the UAV was there; `closest_m` is how near it came, in three
    dimensions.
    """

    uav: str
    waypoint_id: int
    planned_s: float
    reached_s: float | None = None
    closest_m: float = math.inf

    @property
    def late_s(self) -> float | None:
        """Seconds behind the plan, negative when early."""
        return None if self.reached_s is None else self.reached_s - self.planned_s

    @property
    def visited(self) -> bool:
        """Whether it was passed closely enough."""
        return self.closest_m <= VISITED_M
