"""What the vehicle believes about its position, and when: GPS fix, EKF status, origin, home."""

from __future__ import annotations

from jfto_sim.params import Parameters

GPS_FIX_AT_S = 9.9
ORIGIN_AT_S = 19.85
AIDING_AT_S = 41.25
EKF_ACTIVE_AT_S = 4.28
VARIANCE_AFTER_S = 8.0
STOPPED_AIDING_AFTER_S = 15.1
RECOVERED_AFTER_S = 1.2

FLAGS_ALIGNING, FLAGS_AIDING, FLAGS_LOST, FLAGS_LOST_FLYING = 167, 831, 39, 37


class Estimator:
    """EKF and GPS. `lost_at_s` is when the GPS went away, None while it is there."""

    def __init__(self, params: Parameters) -> None:
        self.params = params
        self.lost_at_s: float | None = None
        self.back_at_s = AIDING_AT_S
        self.variance_told = False
        self.aiding_told = True

    @property
    def gps_present(self) -> bool:
        """Whether the receiver has a position."""
        return self.params["SIM_GPS_DISABLE"] == 0

    def update(self, now_s: float) -> None:
        """Note when the GPS goes and comes."""
        if self.gps_present:
            if self.lost_at_s is not None:
                self.back_at_s = max(now_s, AIDING_AT_S)
            self.lost_at_s = None
        elif self.lost_at_s is None:
            self.lost_at_s = now_s

    def lost_for_s(self, now_s: float) -> float:
        """Seconds without GPS, 0 while it is there."""
        return 0.0 if self.lost_at_s is None else now_s - self.lost_at_s

    def has_fix(self, now_s: float) -> bool:
        """Whether the GPS reports a fix."""
        return now_s >= GPS_FIX_AT_S and self.gps_present

    def has_origin(self, now_s: float) -> bool:
        """Whether the EKF origin is set, and with it home."""
        return now_s >= ORIGIN_AT_S

    def active(self, now_s: float) -> bool:
        """Whether the EKF drives the attitude."""
        return now_s >= EKF_ACTIVE_AT_S

    def position_ok(self, now_s: float) -> bool:
        """Whether modes that need a position may be used."""
        return now_s >= AIDING_AT_S and self.lost_for_s(now_s) < VARIANCE_AFTER_S

    def flags(self, now_s: float, *, flying: bool) -> int:
        """EKF_STATUS_REPORT.flags."""
        if now_s < AIDING_AT_S:
            return FLAGS_ALIGNING
        lost_s = self.lost_for_s(now_s)
        if lost_s < VARIANCE_AFTER_S - 0.5:
            return FLAGS_AIDING
        if lost_s >= STOPPED_AIDING_AFTER_S:
            return FLAGS_ALIGNING
        return FLAGS_LOST_FLYING if flying else FLAGS_LOST
