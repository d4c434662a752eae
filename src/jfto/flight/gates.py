"""Time gates of a flight: where the fleet waits for the clock, and when it lifts off for that."""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import dataclass

from jfto_msgs_py.errors import InputError

# From the start of the graph to lift-off: for links, upload and checks, by this computer's clock
# and by the vehicles'; an operator at a terminal has some of it for the word.
WALL_S, FLEET_S = 60.0, 120.0


@dataclass(frozen=True)
class Gates:
    """All wait behind their K-th waypoint, for each K of `waypoints`, for its planned time.

    That counts from a lift-off `lead_s` of the vehicles' time after the graph is started; None: as
    soon as can be counted on.
    """

    waypoints: tuple[int, ...]
    lead_s: float | None = None

    def parameters(self, simulated_fleet: Mapping[str, object] | None) -> dict[str, object]:
        """The bridge's, for a graph that is started now; `simulated_fleet` has its vehicles'."""
        now_s, speedup = time.time(), 1.0
        if simulated_fleet is not None:
            speedup = float(str(simulated_fleet["speedup"]))
            start_s = float(str(simulated_fleet["start_time_s"]))
            now_s = start_s + (now_s - start_s) * speedup
        return {"gates": self.waypoints, "start_at_s": now_s + self.wait_s(speedup)}

    def wait_s(self, speedup: float) -> float:
        """From the start of the graph to lift-off, s of the vehicles' time."""
        return WALL_S * speedup + FLEET_S if self.lead_s is None else self.lead_s


def parse_gates(text: str) -> Gates:
    """Read "K,K…" or "K,K…@S"; raises InputError."""
    waypoints, at, lead = text.partition("@")
    try:
        numbers = tuple(int(part) for part in waypoints.split(","))
        lead_s = float(lead) if at else None
    except ValueError:
        numbers, lead_s = (), None
    if not numbers or min(numbers) < 1 or (lead_s is not None and not 10 <= lead_s <= 86_400):
        raise InputError(
            f"--gates is '{text}', must be numbers of waypoints from 1 on, and behind @ the "
            "seconds until lift-off, 10 or more: 3,6 or 3,6@300."
        )
    return Gates(numbers, lead_s)
