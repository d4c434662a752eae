"""How far a fleet has come along its curves: one clock for all, which can stand and go on."""

from __future__ import annotations

import math
from dataclasses import dataclass

# From standing to full speed, s: at 10 m/s that is 5 m/s² at most, in the middle of it.
RAMP_S = 3.0


@dataclass(frozen=True)
class Progress:
    """Seconds along the curves, how fast they pass (0 to 1), and how that grows per second.

    `begun` is False before time zero; `joint` counts how often the fleet has gone on from standing.
    """

    elapsed_s: float
    rate: float = 1.0
    growth: float = 0.0
    begun: bool = True
    joint: int = 0


class CurveClock:
    """Time along the curves of a fleet, which begin at `zero_s` of the clock that is handed in.

    After a standstill the fleet goes on from where it stands, all together, slowly at first; what
    was lost is never made up, so that whoever was certified to be apart stays apart.
    """

    def __init__(self, zero_s: float) -> None:
        self.zero_s = zero_s
        # Goes on since, from so many seconds along the curves, with a ramp or without.
        self._from = (zero_s, 0.0, 0.0)
        self._joint = 0

    def at(self, now_s: float) -> Progress:
        """Where all are to be now."""
        since_s, elapsed_s, ramp_s = self._from
        gone_s = now_s - since_s
        if gone_s < 0:
            return Progress(elapsed_s, 0.0, 0.0, begun=self._joint > 0, joint=self._joint)
        if gone_s >= ramp_s:
            return Progress(elapsed_s + gone_s - ramp_s / 2, joint=self._joint)
        u = gone_s / ramp_s
        return Progress(
            elapsed_s + ramp_s * (u**3 - u**4 / 2),
            3 * u**2 - 2 * u**3,
            6 * u * (1 - u) / ramp_s,
            joint=self._joint,
        )

    def stand(self, now_s: float) -> None:
        """All are told to hold: time along the curves stands until they go on."""
        self._from = (math.inf, self.at(now_s).elapsed_s, RAMP_S)

    def go_on(self, now_s: float, elapsed_s: float) -> None:
        """All stand at a place of their curves, and go on from there."""
        self._from = (now_s, elapsed_s, RAMP_S)
        self._joint += 1

    def begin_anew(self, zero_s: float) -> None:
        """Other curves, in mid-flight: their time zero."""
        self.zero_s, self._from = zero_s, (zero_s, 0.0, 0.0)

    def late_s(self, now_s: float) -> float:
        """By how much the fleet is later than at lift-off, once it is at full speed."""
        since_s, elapsed_s, ramp_s = self._from
        return (
            max(now_s, since_s) - self.zero_s - (elapsed_s + max(now_s - since_s, 0.0) - ramp_s / 2)
        )
