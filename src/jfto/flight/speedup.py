"""How fast simulated vehicles' time may pass on this computer."""

from __future__ import annotations

import os

# Vehicles times speed-up that one core is asked to carry with the whole graph beside them; what
# that leaves idle is in docs/how-to/run.md. Faster than the greatest nobody needs.
PER_CORE = 40.0
GREATEST = 10.0


def default_speedup(vehicle_count: int) -> float:
    """Speed-up at which a fleet of simulated vehicles does not fall behind."""
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
    return max(1.0, min(GREATEST, round(PER_CORE * (cores or 1) / vehicle_count, 1)))
