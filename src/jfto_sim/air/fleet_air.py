"""The air around vehicles that fly: stepped in their time, set by lines of text."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from jfto_msgs_py.air import AirReport
from jfto_msgs_py.errors import InputError
from jfto_msgs_py.types import Array
from jfto_sim.air.air import Air
from jfto_sim.geodesy import UNITS_PER_DEGREE
from jfto_sim.vehicle import Vehicle

# ENU metres (A, 3) of latitudes, longitudes (degrees) and heights above sea level (m), all (A,).
ToEnu = Callable[[Array, Array, Array], Array]

# Seconds of the vehicles' time between two looks at the air.
PERIOD_S = 0.5


class FleetAir:
    """Radio k of `air` is aboard the k-th vehicle; `to_enu` is the frame of the air's ground.

    Links follow true positions. Energy is charged while any vehicle is armed: before, the fleet
    stands on its pads and the mission's account is not open. `latest` is the last report, made
    every PERIOD_S seconds and stamped in the vehicles' UTC; None before the first.
    """

    def __init__(self, air: Air, to_enu: ToEnu) -> None:
        self.air = air
        self.latest: AirReport | None = None
        self._to_enu = to_enu
        self._last_s: float | None = None

    def step(self, vehicles: Sequence[Vehicle]) -> None:
        """Look at the air if it is time; `vehicles` are those of the radios, in their order."""
        now_s = max(vehicle.total_s for vehicle in vehicles)
        if self._last_s is not None and now_s - self._last_s < PERIOD_S:
            return
        dt_s = 0.0 if self._last_s is None else now_s - self._last_s
        self._last_s = now_s
        places = (
            np.array([vehicle.flight.position.true() for vehicle in vehicles]) / UNITS_PER_DEGREE
        )
        heights = np.array([v.config.home_alt_m + v.body.position_m[2] for v in vehicles])
        self.latest = self.air.step(
            dt_s,
            self._to_enu(places[:, 0], places[:, 1], heights),
            switched_on=np.array([not vehicle.dead for vehicle in vehicles]),
            metered=any(vehicle.flight.motors.armed and not vehicle.dead for vehicle in vehicles),
            stamp_ns=1000 * max(v.config.utc_at_boot_us + round(v.total_s * 1e6) for v in vehicles),
        )

    def order(self, number: int, words: Sequence[str]) -> str:
        """Carry out `radio NUMBER WORDS` and answer with the power that is set, dBm.

        A power sets the radio, nothing reads it; dead, stuck and mend are its faults. Raises
        InputError for other words, and where the radio does not answer.
        """
        uav_id = self.air.uav_ids[number]
        if not words:
            return repr(self.air.power_dbm(uav_id))
        if len(words) != 1:
            raise InputError(f"'radio {' '.join(words)}': one word or none must follow the number.")
        word = words[0]
        if word == "dead":
            self.air.set_dead(uav_id)
            return ""
        if word == "mend":
            self.air.set_dead(uav_id, dead=False)
            self.air.set_stuck(uav_id, stuck=False)
            return ""
        if word == "stuck":
            self.air.set_stuck(uav_id)
            return ""
        try:
            dbm = float(word)
        except ValueError:
            raise InputError(
                f"radio order is '{word}', must be a power in dBm, dead, stuck or mend."
            ) from None
        return repr(self.air.set_power(uav_id, dbm))
