"""Powers for the slots ahead, against the energy that is really left."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from jfto_msgs_py.errors import MessageError
from jfto_msgs_py.network import Adjacency, PowerIntervals, PowerSchedule
from jfto_msgs_py.radio import Radio
from jfto_power.allocation import allocate, allocate_prefix
from jfto_power.shortage import EnergyShortage
from jfto_world.radio import Channel, pairwise_distances

Array = NDArray[np.float64]


@dataclass(frozen=True)
class HorizonPower:
    """Schedule of one horizon; `shortage` says who cannot afford it, None if all can."""

    schedule: PowerSchedule
    shortage: EnergyShortage | None


class EnergyBook:
    """Energy left to each UAV, J, and the powers in force that draw on it."""

    def __init__(self, budget_j: dict[str, float]) -> None:
        self.left_j = dict(budget_j)
        self._power_w = dict.fromkeys(budget_j, 0.0)
        self._since_ns: int | None = None

    def advance(self, now_ns: int) -> None:
        """Charge the powers in force until now."""
        if self._since_ns is not None and now_ns > self._since_ns:
            duration_s = (now_ns - self._since_ns) / 1e9
            for uav_id, power_w in self._power_w.items():
                self.left_j[uav_id] = max(self.left_j[uav_id] - power_w * duration_s, 0.0)
        self._since_ns = max(now_ns, self._since_ns or now_ns)

    def set_powers(self, now_ns: int, power_w: dict[str, float]) -> None:
        """Put powers in force; a UAV that is not named keeps its own."""
        self.advance(now_ns)
        self._power_w.update(power_w)


def plan_horizon(
    adjacency: Adjacency,
    intervals: PowerIntervals,
    positions_m: Array,
    left_j: dict[str, float],
    *,
    slot_count: int,
    channel: Channel,
    radio: Radio,
) -> HorizonPower:
    """Best powers of a horizon.

    `positions_m` is (slots, UAVs, 3) in the order of `adjacency.uav_ids`. A horizon that ends
    before slot N may use its share of the energy left, but never less than its least powers cost.
    The current slot costs energy like any other. Raises MessageError if the two messages are not
    of one horizon. Source: (P4).
    """
    if adjacency.horizon != intervals.horizon or adjacency.uav_ids != intervals.uav_ids:
        raise MessageError("power_interval", "is not of the same horizon as the adjacency")
    horizon = adjacency.horizon
    gain = channel.gain(pairwise_distances(positions_m))
    low, high = intervals.bounds_w[..., 0], intervals.bounds_w[..., 1]
    left = np.array([left_j[uav_id] for uav_id in adjacency.uav_ids])
    floor = low.sum(axis=0) * horizon.duration_s
    slots_left = max(slot_count + 1 - horizon.first, horizon.count)
    budget = np.minimum(np.maximum(left * (horizon.count / slots_left), floor), left)
    # The allocator lets its first slot go free; here none is, so one is put in front.
    arguments = (
        _with_front(adjacency.links),
        _with_front(gain),
        _with_front(low),
        _with_front(high),
        budget,
        horizon.duration_s,
        radio,
    )
    try:
        power, shortage = allocate(*arguments, names=adjacency.uav_ids).power_w, None
    except EnergyShortage as error:
        power, shortage = allocate_prefix(*arguments).power_w, error
    return HorizonPower(PowerSchedule(horizon, adjacency.uav_ids, power[1:]), shortage)


def _with_front(array: NDArray) -> NDArray:
    return np.concatenate([array[:1], array])
