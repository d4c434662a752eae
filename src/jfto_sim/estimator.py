"""What the vehicle believes about its position, and when: GPS fix, EKF status, origin, home."""

from __future__ import annotations

from dataclasses import dataclass

from jfto_sim.clock import Clock
from jfto_sim.parameters import Parameters

GPS_FIX_AT_S = 9.9
ORIGIN_AT_S = 19.85
AIDING_AT_S = 41.25
EKF_ACTIVE_AT_S = 4.28
VARIANCE_AFTER_S = 8.0
STOPPED_AIDING_AFTER_S = 15.1
RECOVERED_AFTER_S = 1.2

FLAGS_ALIGNING, FLAGS_AIDING, FLAGS_LOST, FLAGS_LOST_FLYING = 167, 831, 39, 37


@dataclass
class Estimator:
    """EKF and GPS. `back_at_s` is when the GPS came back, or was first used."""

    params: Parameters
    clock: Clock
    back_at_s: float = AIDING_AT_S
    _lost_at_s: float | None = None

    @property
    def gps_present(self) -> bool:
        """Whether the receiver has a position."""
        return self.params["SIM_GPS_DISABLE"] == 0

    def update(self) -> None:
        """Note when the GPS goes and comes."""
        if self.gps_present:
            if self._lost_at_s is not None:
                self.back_at_s = max(self.clock.time_s, AIDING_AT_S)
            self._lost_at_s = None
        elif self._lost_at_s is None:
            self._lost_at_s = self.clock.time_s

    @property
    def lost_for_s(self) -> float:
        """Seconds without GPS, 0 while it is there."""
        return 0.0 if self._lost_at_s is None else self.clock.time_s - self._lost_at_s

    @property
    def has_fix(self) -> bool:
        """Whether the GPS reports a fix."""
        return self.clock.time_s >= GPS_FIX_AT_S and self.gps_present

    @property
    def has_origin(self) -> bool:
        """Whether the EKF origin is set, and with it home."""
        return self.clock.time_s >= ORIGIN_AT_S

    @property
    def active(self) -> bool:
        """Whether the EKF drives the attitude."""
        return self.clock.time_s >= EKF_ACTIVE_AT_S

    @property
    def position_ok(self) -> bool:
        """Whether modes that need a position may be used."""
        return self.clock.time_s >= AIDING_AT_S and self.lost_for_s < VARIANCE_AFTER_S

    def flags(self, *, flying: bool) -> int:
        """EKF_STATUS_REPORT.flags."""
        if self.clock.time_s < AIDING_AT_S:
            return FLAGS_ALIGNING
        if self.lost_for_s < VARIANCE_AFTER_S - 0.5:
            return FLAGS_AIDING
        if self.lost_for_s >= STOPPED_AIDING_AFTER_S:
            return FLAGS_ALIGNING
        return FLAGS_LOST_FLYING if flying else FLAGS_LOST
