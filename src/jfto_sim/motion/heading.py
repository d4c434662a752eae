"""Which way the nose is asked to point: along the route, at a fixed angle, or at a place."""

from __future__ import annotations

import math
from enum import Enum

from jfto_sim.geodesy import wrap_180, wrap_360

SLEW_DPS = 60.0
REACHED_DEG = 2.0
_FOLLOW_SPEED_MPS = 0.5


class YawMode(Enum):
    """What decides the heading."""

    HOLD = "hold"
    ALONG_TRACK = "along track"
    FIXED = "fixed"
    PLACE = "place"
    RATE = "rate"
    STREAM = "stream"


class Heading:
    """The demanded heading, slewed at 60 degrees per second unless an item asks otherwise."""

    def __init__(self, heading_deg: float) -> None:
        self.mode = YawMode.HOLD
        self.demand_deg = wrap_360(heading_deg)
        self.rate_dps = 0.0
        self._left_deg = 0.0
        # Where a turn is to be by now; while a heading is held, where the route leads.
        self._target_deg = self.demand_deg
        self._slew_dps = SLEW_DPS
        self._stream_deg = 0.0
        self.place_m: tuple[float, float] = (0.0, 0.0)

    def hold(self) -> None:
        """Keep the heading that is demanded now."""
        self.mode, self.rate_dps = YawMode.HOLD, 0.0

    def follow_track(self) -> None:
        """Point along the target's motion from now on."""
        self.mode = YawMode.ALONG_TRACK

    def turn_to(self, angle_deg: float, rate_dps: float, direction: int, *, relative: bool) -> None:
        """CONDITION_YAW: clockwise (1), counter-clockwise (-1) or the short way (0) to an angle.

        A turn from a heading that is held begins as if the nose pointed along the route.
        """
        if self.mode is not YawMode.HOLD or relative:
            self._target_deg = self.demand_deg
        if relative:
            self._left_deg = angle_deg * (-1.0 if direction < 0 else 1.0)
        else:
            self._left_deg = wrap_180(angle_deg - self._target_deg)
            if direction < 0 < self._left_deg:
                self._left_deg -= 360.0
            elif direction > 0 > self._left_deg:
                self._left_deg += 360.0
        self._slew_dps = min(rate_dps, SLEW_DPS) if rate_dps > 0 else SLEW_DPS
        self.mode = YawMode.FIXED

    def look_at(self, east_m: float, north_m: float) -> None:
        """Point at a place."""
        self.mode, self.place_m = YawMode.PLACE, (east_m, north_m)

    def stream(self, heading_deg: float, rate_dps: float) -> None:
        """A heading that the station sends over and over, with the rate at which it changes."""
        self.mode = YawMode.STREAM
        self.rate_dps = rate_dps
        self._stream_deg = heading_deg

    def set_rate(self, rate_dps: float) -> None:
        """Turn at a rate."""
        self.mode, self.rate_dps = YawMode.RATE, rate_dps

    def reached(self, heading_deg: float) -> bool:
        """Whether a CONDITION_YAW is done: slewed to its end and within two degrees of it."""
        if self.mode is not YawMode.FIXED:
            return True
        return (
            self._left_deg == 0.0 and abs(wrap_180(self._target_deg - heading_deg)) <= REACHED_DEG
        )

    def step(
        self,
        position_m: tuple[float, float],
        velocity_mps: tuple[float, float],
        dt_s: float,
    ) -> tuple[float, float]:
        """Advance the demand; `velocity_mps` is the target's.

        Returns the heading and the rate to feed forward, which only a station's own rates are.
        """
        before = self.demand_deg
        if self.mode is YawMode.FIXED:
            step = math.copysign(min(abs(self._left_deg), self._slew_dps * dt_s), self._left_deg)
            self._left_deg -= step
            self._target_deg = wrap_360(self._target_deg + step)
            self._slew(self._target_deg, dt_s)
        elif self.mode is YawMode.HOLD:
            self._target_deg = self._wanted(position_m, velocity_mps, self._target_deg)
        elif self.mode is YawMode.STREAM:
            self._stream_deg += self.rate_dps * dt_s
            self._slew(self._stream_deg, dt_s)
        elif self.mode is YawMode.RATE:
            self.demand_deg = wrap_360(self.demand_deg + self.rate_dps * dt_s)
        elif self.mode in (YawMode.ALONG_TRACK, YawMode.PLACE):
            self._slew(self._wanted(position_m, velocity_mps, self.demand_deg), dt_s)
        fed = self.mode in (YawMode.RATE, YawMode.STREAM)
        return self.demand_deg, wrap_180(self.demand_deg - before) / dt_s if fed else 0.0

    def _wanted(
        self,
        position_m: tuple[float, float],
        velocity_mps: tuple[float, float],
        at_rest_deg: float,
    ) -> float:
        if self.mode is YawMode.PLACE:
            east, north = self.place_m[0] - position_m[0], self.place_m[1] - position_m[1]
        elif math.hypot(*velocity_mps) < _FOLLOW_SPEED_MPS:
            return at_rest_deg
        else:
            east, north = velocity_mps
        return math.degrees(math.atan2(east, north))

    def _slew(self, wanted_deg: float, dt_s: float) -> None:
        error = wrap_180(wanted_deg - self.demand_deg)
        limit = SLEW_DPS * dt_s
        self.demand_deg = wrap_360(self.demand_deg + min(limit, max(-limit, error)))
