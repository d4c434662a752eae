"""Powers for the slots ahead, against the energy that is really left."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from jfto_msgs_py.clock_watch import SET_BACK_NS
from jfto_msgs_py.errors import MessageError
from jfto_msgs_py.network import Adjacency, PowerIntervals, PowerSchedule
from jfto_msgs_py.radio import Radio
from jfto_msgs_py.types import Array
from jfto_power.allocation import allocate
from jfto_power.shortage import EnergyShortage, affordable_slots, check_energy
from jfto_world.radio import Channel, pairwise_distances

_FOREVER_S = 1e6


@dataclass(frozen=True)
class HorizonPower:
    """Schedule of one horizon; `shortage` says who cannot afford it, None if all can."""

    schedule: PowerSchedule
    shortage: EnergyShortage | None


class EnergyBook:
    """Energy left to each UAV, J, and the powers in force that draw on it.

    Nothing is charged for before `zero_ns`, the mission's time zero, or at all while that is None.
    """

    def __init__(self, budget_j: dict[str, float], zero_ns: int | None = 0) -> None:
        self.left_j = dict(budget_j)
        self.charged_from_ns: int | None = None
        self._power_w = dict.fromkeys(budget_j, 0.0)
        self._zero_ns = zero_ns
        self._opened_ns: int | None = None
        self._since_ns: int | None = None

    def advance(self, now_ns: int) -> None:
        """Charge the powers in force until now; a clock that was set back begins anew."""
        if self._since_ns is None or self._opened_ns is None:
            self._since_ns = self._opened_ns = now_ns
        elif now_ns < self._since_ns - SET_BACK_NS:
            self._since_ns = now_ns
        elif now_ns > self._since_ns:
            if self._zero_ns is not None:
                self._charge(max(self._since_ns, self._zero_ns), now_ns)
            self._since_ns = now_ns

    def set_powers(self, now_ns: int, power_w: dict[str, float]) -> None:
        """Put powers in force; a UAV that is not named keeps its own."""
        self.advance(now_ns)
        self._power_w.update(power_w)

    def set_zero(self, zero_ns: int) -> None:
        """Say when the mission begins, or began: the time since is charged, once.

        What has been charged stays charged, wherever time zero is put later.
        """
        begun_ns = self.charged_from_ns
        if begun_ns is None:
            self._zero_ns, begun_ns = zero_ns, self._since_ns
        if begun_ns is not None and self._opened_ns is not None:
            self._charge(max(zero_ns, self._opened_ns), begun_ns)

    def empty_ns(self) -> int | None:
        """When the first UAV has used up its energy at the powers in force; None: never."""
        if self._since_ns is None or self._zero_ns is None:
            return None
        spans_s = [
            self.left_j[uav_id] / power_w
            for uav_id, power_w in self._power_w.items()
            if power_w > 0
        ]
        if not spans_s:
            return None
        return max(self._since_ns, self._zero_ns) + round(min(*spans_s, _FOREVER_S) * 1e9)

    def _charge(self, from_ns: int, until_ns: int) -> None:
        if until_ns <= from_ns:
            return
        if self.charged_from_ns is None or from_ns < self.charged_from_ns:
            self.charged_from_ns = from_ns
        duration_s = (until_ns - from_ns) / 1e9
        for uav_id, power_w in self._power_w.items():
            self.left_j[uav_id] = max(self.left_j[uav_id] - power_w * duration_s, 0.0)


def plan_horizon(
    adjacency: Adjacency,
    intervals: PowerIntervals,
    positions_m: Array,
    left_j: dict[str, float],
    *,
    slot_count: int,
    channel: Channel,
    radio: Radio,
    reserve: float = 0.0,
) -> HorizonPower:
    """Best powers of a horizon.

    `positions_m` is (slots, UAVs, 3) in the order of `adjacency.uav_ids`. A horizon that ends
    before slot N may use its share of the energy left, but never less than its least powers cost;
    at slot N and on the way home the least powers are all that is spent. The current slot costs
    energy like any other, and `reserve` is the share of what is left that is only spent on least
    powers, for a future that turns out dearer than predicted. A UAV that cannot pay for its least
    powers is held as long as it can and silent then; the others go on. Raises MessageError if the
    two messages are not of one horizon. Source: (P4).
    """
    if adjacency.horizon != intervals.horizon or adjacency.uav_ids != intervals.uav_ids:
        raise MessageError("power_interval", "is not of the same horizon as the adjacency")
    horizon = adjacency.horizon
    gain = channel.gain(pairwise_distances(positions_m))
    low, high, links = intervals.bounds_w[..., 0], intervals.bounds_w[..., 1], adjacency.links
    left = np.array([left_j[uav_id] for uav_id in adjacency.uav_ids])
    floor = low.sum(axis=0) * horizon.duration_s
    slots_left = max(slot_count + 1 - horizon.first, horizon.count)
    share = 0.0 if horizon.first >= slot_count else (1.0 - reserve) * horizon.count / slots_left
    budget = np.minimum(np.maximum(left * share, floor), left)
    shortage = None
    try:
        check_energy(_with_front(low), budget, horizon.duration_s, adjacency.uav_ids)
    except EnergyShortage as error:
        shortage = error
        held = affordable_slots(_with_front(low), budget, horizon.duration_s)
        on = np.arange(horizon.count)[:, None] < held
        low, high = np.where(on, low, 0.0), np.where(on, high, 0.0)
        links = links & on[:, :, None] & on[:, None, :]
    # The allocator lets its first slot go free; here none is, so one is put in front.
    best = allocate(
        _with_front(links),
        _with_front(gain),
        _with_front(low),
        _with_front(high),
        budget,
        horizon.duration_s,
        radio,
    )
    schedule = PowerSchedule(horizon, adjacency.uav_ids, best.power_w[1:])
    return HorizonPower(schedule, shortage)


def _with_front(array: NDArray) -> NDArray:
    return np.concatenate([array[:1], array])
