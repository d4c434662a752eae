"""What the conductor goes by: the fleet as it was last heard of."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field


@dataclass(frozen=True)
class UavSeen:
    """One vehicle: whether it is heard now, for how long it has not been (s of its clock), …

    … whether it is armed, in which mode, and how many of its waypoints it has reached.
    """

    heard: bool = False
    silent_s: float = float("inf")
    armed: bool = False
    mode: str = ""
    reached: int = 0

    @property
    def down(self) -> bool:
        """Whether it is known to be disarmed."""
        return self.heard and not self.armed


@dataclass(frozen=True)
class Seen:
    """The fleet at `now_s` of this computer's clock and `fleet_s` of the vehicles'.

    `note` says why the bridge is not linked, "" if it is. `planned` says that the planner has
    published the plan.
    """

    now_s: float
    fleet_s: float
    note: str
    planned: bool
    uavs: Mapping[str, UavSeen] = field(default_factory=dict)

    @property
    def all_heard(self) -> bool:
        """Whether every vehicle is heard now."""
        return not self.note and bool(self.uavs) and all(u.heard for u in self.uavs.values())

    @property
    def all_down(self) -> bool:
        """Whether every vehicle is known to be disarmed."""
        return not self.note and bool(self.uavs) and all(u.down for u in self.uavs.values())
