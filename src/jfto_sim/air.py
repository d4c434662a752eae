"""The air between simulated radios: powers really set, links that hold, energy really used."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from jfto_msgs_py.errors import InputError
from jfto_msgs_py.records.air import AirReport
from jfto_msgs_py.records.radio import Radio
from jfto_msgs_py.types import Array, Flags
from jfto_msgs_py.units import db_to_ratio, dbm_to_w, ratio_to_db
from jfto_sim.channel import (
    AirSettings,
    Ground,
    Shadowing,
    delivery_share,
    terrain_loss_db,
)
from jfto_sim.geodesy import UNITS_PER_DEGREE
from jfto_sim.vehicle import Vehicle
from jfto_world.radio import make_channel, mutual_links, pairwise_distances, rate_bps

# Below this share of packets a receiver says nothing about the sender.
_RECEIVED_SHARE = 0.01
# ENU metres (A, 3) of latitudes, longitudes (degrees) and heights above sea level (m), all (A,).
ToEnu = Callable[[Array, Array, Array], Array]
# Seconds of the vehicles' time between two looks at the air.
PERIOD_S = 0.5

__all__ = ["Air", "AirMember", "AirSettings", "FleetAir", "Ground"]


@dataclass(frozen=True)
class AirMember:
    """A UAV's radio: its greatest power in dBm and the energy in joules it may send with."""

    uav_id: str
    p_max_dbm: float
    energy_j: float


class Air:
    """Radios and the channel between them; advanced by `step`, knows no clock of its own.

    A radio begins at its greatest power, as radios do, and sends nothing once its energy is gone,
    it is dead, or its vehicle is off. `ground` adds the loss behind ridges.
    """

    def __init__(
        self,
        members: Sequence[AirMember],
        radio: Radio,
        settings: AirSettings | None = None,
        ground: Ground | None = None,
    ) -> None:
        self._members = {member.uav_id: k for k, member in enumerate(members)}
        self._radio, self._settings = radio, settings or AirSettings()
        self._channel = make_channel(radio)
        self._sensitivity_w = float(dbm_to_w(radio.sensitivity_dbm))
        self._ground = ground
        self._shadowing = Shadowing(len(members), self._settings)
        self._p_max_dbm = [member.p_max_dbm for member in members]
        self._set_dbm = list(self._p_max_dbm)
        self._budget_j = np.array([member.energy_j for member in members])
        self._used_j = np.zeros(len(members))
        self._dead = np.zeros(len(members), dtype=np.bool_)
        self._stuck = np.zeros(len(members), dtype=np.bool_)

    @property
    def uav_ids(self) -> tuple[str, ...]:
        """UAVs in the order of all arrays."""
        return tuple(self._members)

    @property
    def left_j(self) -> Array:
        """Energy left to each UAV in joules, (A,)."""
        return np.maximum(self._budget_j - self._used_j, 0.0)

    def set_power(self, uav_id: str, dbm: float) -> float:
        """Set a radio to a power in dBm, -inf for silence; returns what it is then set to.

        A radio cannot do more than its greatest power, and a stuck one stays as it is. Raises
        InputError for a radio that there is none of, that is dead, or a power that is no number.
        """
        k = self._living(uav_id)
        if math.isnan(dbm) or dbm == math.inf:
            raise InputError(f"power of {uav_id} is {dbm} dBm, must be a number or -inf.")
        if not self._stuck[k]:
            self._set_dbm[k] = min(dbm, self._p_max_dbm[k])
        return self._set_dbm[k]

    def power_dbm(self, uav_id: str) -> float:
        """What a radio is set to, dBm. Raises InputError where it does not answer."""
        return self._set_dbm[self._living(uav_id)]

    def set_dead(self, uav_id: str, dead: bool = True) -> None:
        """Break a radio, or mend it."""
        self._dead[self._index(uav_id)] = dead

    def set_stuck(self, uav_id: str, stuck: bool = True) -> None:
        """Let a radio ignore what it is told, or obey again."""
        self._stuck[self._index(uav_id)] = stuck

    def step(
        self,
        dt_s: float,
        positions_m: Array,
        *,
        switched_on: Flags | None = None,
        metered: bool = True,
        stamp_ns: int = 0,
    ) -> AirReport:
        """Let `dt_s` seconds pass with the fleet at `positions_m` (A, 3), ENU metres.

        `switched_on` (A,) marks vehicles with power. Energy is charged only while `metered`, for
        the powers set; a radio that runs out within the step is silent from its end on. The report
        holds what is so at the end of the step, stamped `stamp_ns`.
        """
        on = ~self._dead if switched_on is None else ~self._dead & switched_on
        power_w = dbm_to_w(np.array(self._set_dbm))
        if metered:
            sent_w = np.where(on & (self.left_j > 0), power_w, 0.0)
            self._used_j = np.minimum(self._used_j + sent_w * dt_s, self._budget_j)
        power_w = np.where(on & (self.left_j > 0), power_w, 0.0)
        gain = self._gain(dt_s, positions_m)
        links = mutual_links(gain, power_w, self._sensitivity_w)
        margin_db = ratio_to_db(power_w[:, None] * gain / self._sensitivity_w)
        # Half duplex: who does not send does not acknowledge either.
        share = np.where((power_w > 0)[None, :], delivery_share(margin_db), 0.0)
        np.fill_diagonal(share, 0.0)
        return AirReport(
            stamp_ns=stamp_ns,
            uav_ids=self.uav_ids,
            power_w=power_w,
            energy_j=self._used_j.copy(),
            rate_bps=np.where(links, rate_bps(self._radio, power_w[:, None], gain), 0.0),
            delivery=share,
            gain=np.where(share > _RECEIVED_SHARE, gain, 0.0),
        )

    def _gain(self, dt_s: float, positions_m: Array) -> Array:
        loss_db = self._settings.path_loss_error_db + self._shadowing.step(dt_s, positions_m)
        if self._ground is not None:
            loss_db = loss_db + terrain_loss_db(positions_m, self._ground, self._radio.frequency_hz)
        return self._channel.gain(pairwise_distances(positions_m)) * db_to_ratio(-loss_db)

    def _index(self, uav_id: str) -> int:
        if uav_id not in self._members:
            raise InputError(f"There is no radio of {uav_id}; there are {', '.join(self.uav_ids)}.")
        return self._members[uav_id]

    def _living(self, uav_id: str) -> int:
        k = self._index(uav_id)
        if self._dead[k]:
            raise InputError(f"The radio of {uav_id} does not answer: it is dead.")
        return k


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
