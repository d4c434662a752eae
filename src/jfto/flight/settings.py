"""How a flight is conducted, and how long anything is waited for."""

from __future__ import annotations

import os
from dataclasses import dataclass

# Vehicles times speed-up that one core is asked to carry with the whole graph beside them; what
# that leaves idle is in docs/how-to/run.md. Faster than the greatest nobody needs.
PER_CORE = 40.0
GREATEST = 10.0
UPLOAD, ARM, LANDED = "upload", "arm", "landed"


@dataclass(frozen=True)
class Patience:
    """Longest waits, in seconds of this computer; they include the vehicles' own time-outs.

    `order_s` is for an order's answer, `again_s` between two tries of an abort, `settle_s` for what
    was ordered to show; after `tell_s` it is said what is waited for.
    """

    link_s: float = 180.0
    order_s: float = 300.0
    abort_s: float = 60.0
    again_s: float = 5.0
    settle_s: float = 8.0
    tell_s: float = 2.0


@dataclass(frozen=True)
class ConductSettings:
    """`until` is UPLOAD, ARM or LANDED; `ask` lets the operator decide before anything arms, and
    `resume` takes over a flight that is under way.

    A flight may take `flight_s` and the way home `home_s` of the vehicles' time, and as this
    computer counts `wall_factor` times that over `speedup`. A vehicle silent for `lost_s` of its
    time is given up; its own failsafes act.
    """

    plan_s: float
    until: str = LANDED
    ask: bool = False
    resume: bool = False
    speedup: float = 1.0
    home_s: float = 600.0
    lost_s: float = 120.0
    wall_factor: float = 4.0
    patience: Patience = Patience()

    @property
    def flight_s(self) -> float:
        """Longest flight, in s of the vehicles' time."""
        return 1.5 * self.plan_s + self.home_s

    def wall_s(self, fleet_s: float) -> float:
        """How long this computer waits for so much of the vehicles' time."""
        return 30.0 + self.wall_factor * fleet_s / self.speedup


def default_speedup(vehicle_count: int) -> float:
    """Speed-up at which a fleet of simulated vehicles does not fall behind."""
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
    return max(1.0, min(GREATEST, round(PER_CORE * (cores or 1) / vehicle_count, 1)))
