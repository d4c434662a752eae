"""Which way to look when: towards the next photo's heading, turned at a gentle rate."""

from __future__ import annotations

from bisect import bisect_right
from dataclasses import dataclass

# ArduCopter turns at up to 90 deg/s; this leaves room for the wind.
TURN_DPS = 45.0


@dataclass(frozen=True)
class HeadingPlan:
    """Headings (degrees clockwise from north) of photos at `arrival_s` seconds from lift-off."""

    arrival_s: tuple[float, ...]
    yaw_deg: tuple[float, ...]

    def at(self, elapsed_s: float) -> tuple[float, float] | None:
        """Heading (deg) and rate (deg/s) then; None without photos.

        After a photo it turns to the next one's heading, the short way.
        """
        if not self.yaw_deg:
            return None
        ahead = min(bisect_right(self.arrival_s, elapsed_s), len(self.yaw_deg) - 1)
        goal = self.yaw_deg[ahead]
        if ahead == 0:
            return goal % 360.0, 0.0
        before, since_s = self.yaw_deg[ahead - 1], self.arrival_s[ahead - 1]
        turn = (goal - before + 180.0) % 360.0 - 180.0
        turned = min(TURN_DPS * max(elapsed_s - since_s, 0.0), abs(turn))
        if turned >= abs(turn):
            return goal % 360.0, 0.0
        sign = 1.0 if turn > 0 else -1.0
        return (before + sign * turned) % 360.0, sign * TURN_DPS
