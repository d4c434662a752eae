"""What the autopilot says while it powers up, with the times at which ArduCopter 4.5.5 says it.

Most of it goes only to ports on which something has been heard; origin and home go to all.
"""

from __future__ import annotations

from dataclasses import dataclass

from jfto_sim.clock import Clock
from jfto_sim.dialect import INFO
from jfto_sim.flight_loop import FlightLoop
from jfto_sim.parameters import ParameterProtocol
from jfto_sim.ports import Ports
from jfto_sim.position import Position

_FIRST_COUNT = 1362

_TEXTS = (
    (0.150, "Calibrating barometer"),
    (1.747, "Barometer 1 calibration complete"),
    (1.748, "Barometer 2 calibration complete"),
    (2.278, "ArduPilot Ready"),
    (2.279, "AHRS: DCM active"),
    (2.575, "RC7: SaveWaypoint LOW"),
    (4.277, "EKF3 IMU0 initialised"),
    (4.278, "EKF3 IMU1 initialised"),
    (4.283, "AHRS: EKF3 active"),
    (5.626, "EKF3 IMU0 tilt alignment complete"),
    (5.627, "EKF3 IMU1 tilt alignment complete"),
    (5.725, "EKF3 IMU0 MAG0 initial yaw alignment complete"),
    (5.726, "EKF3 IMU1 MAG0 initial yaw alignment complete"),
    (9.632, "GPS 1: detected as u-blox at 230400 baud"),
    (19.851, "EKF3 IMU0 origin set"),
    (19.876, "Field Elevation Set: {elevation:.0f}m"),
    (20.044, "EKF3 IMU1 origin set"),
    (41.250, "EKF3 IMU0 is using GPS"),
    (41.452, "EKF3 IMU1 is using GPS"),
)
# texts that are said once per power-up, and when
TEXT_TIMES_S = {text: time_s for time_s, text in _TEXTS}
_GYRO = tuple(
    f"INS_{n}"
    for n in (
        "GYROFFS_X", "GYROFFS_Y", "GYROFFS_Z", "GYR_ID", "GYR1_CALTEMP", "GYR2OFFS_X",
        "GYR2OFFS_Y", "GYR2OFFS_Z", "GYR2_ID", "GYR2_CALTEMP", "GYR3OFFS_X", "GYR3OFFS_Y",
        "GYR3OFFS_Z", "GYR3_ID",
    )
)  # fmt: skip
_COMPASS = ("COMPASS_DEV_ID", "COMPASS_DEV_ID2", "COMPASS_DEV_ID3")
# (time, names, only at the very first power-up, params known before all are counted)
_PARAMETERS: tuple[tuple[float, tuple[str, ...], bool, bool], ...] = (
    (0.049, (*_COMPASS, "COMPASS_EXTERNAL", "ESC_CALIBRATION"), True, True),
    (0.055, ("RELAY1_FUNCTION", *_COMPASS), True, False),
    (0.152, ("MNT1_TYPE", "CAM1_TYPE", "BARO_ALT_OFFSET"), True, False),
    (1.752, ("BARO1_GND_PRESS", "BARO2_GND_PRESS"), False, False),
    (1.753, ("INS_GYR_ID", "INS_ACC_ID", "INS_GYR2_ID", "INS_ACC2_ID"), True, False),
    (2.280, _GYRO, False, False),
    (3.277, ("EK3_SRC1_POSXY",), True, False),
    (19.876, ("BARO1_GND_PRESS", "BARO2_GND_PRESS"), False, False),
)
HOME_AT_S = 19.851
_STAT_FIRST_S, _STAT_EVERY_S = 30.281, 31.007


@dataclass
class Boot:
    """Plays the power-up list once the vehicle's clock passes each entry; then the statistics.

    `boots` counts the power-ups up to this one, `elevation_m` is the height above sea level.
    """

    clock: Clock
    ports: Ports
    parameters: ParameterProtocol
    position: Position
    boots: int
    elevation_m: float
    loop: FlightLoop
    _at: int = 0
    _stat_s: float = _STAT_FIRST_S
    _counted_flight_s: int = 0

    def __post_init__(self) -> None:
        first = self.boots == 1
        self._run_before_s = 0 if first else int(self.parameters.params["STAT_RUNTIME"])
        events: list[tuple[float, int, str]] = [(t, 0, text) for t, text in _TEXTS]
        for time_s, names, only_first, early in _PARAMETERS:
            if first or not only_first:
                events += [(time_s, 1 if early else 2, name) for name in names]
        if not first:
            events += [(1.753, 2, name) for name in ("INS_ACC_ID", "INS_ACC2_ID")]
        events.append((HOME_AT_S, 3, ""))
        # texts before parameters at one instant, both in the order given
        self._events = sorted(events, key=lambda e: e[0])

    @property
    def next_s(self) -> float:
        """When something is to be said next."""
        due = self._events[self._at][0] if self._at < len(self._events) else float("inf")
        return min(due, self._stat_s)

    def tick(self) -> None:
        """Say what is due."""
        now = self.clock.time_s
        while self._at < len(self._events) and self._events[self._at][0] <= now + 1e-9:
            _, kind, what = self._events[self._at]
            self._at += 1
            if kind == 0:
                self.ports.text(INFO, what.format(elevation=self.elevation_m))
            elif kind == 3:
                self.position.announce_home()
            else:
                self.parameters.announce(what, _FIRST_COUNT if kind == 1 else None)
        if now >= self._stat_s:
            self._stat_s += _STAT_EVERY_S
            self._statistics(now)

    def _statistics(self, now: float) -> None:
        flown_s = int(self.loop.flight_time_s)
        if flown_s != self._counted_flight_s:
            gained, self._counted_flight_s = flown_s - self._counted_flight_s, flown_s
            total = self.parameters.params["STAT_FLTTIME"] + gained
            self.parameters.store_and_announce("STAT_FLTTIME", total)
        self.parameters.store_and_announce("STAT_RUNTIME", self._run_before_s + int(now))
