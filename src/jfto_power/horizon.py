"""Powers for the slots ahead, against the energy that is really left."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from jfto_msgs_py.errors import MessageError
from jfto_msgs_py.records.network import Adjacency, PowerIntervals, PowerSchedule, SlotHorizon
from jfto_msgs_py.records.radio import Radio
from jfto_msgs_py.types import AnyArray, Array
from jfto_power.allocation import PowerProblem, allocate
from jfto_power.shortage import EnergyShortage, affordable_slots, check_energy
from jfto_world.radio import Channel, pairwise_distances


@dataclass(frozen=True)
class HorizonPower:
    """Schedule of one horizon; `shortage` says who cannot afford it, None if all can."""

    schedule: PowerSchedule
    shortage: EnergyShortage | None


@dataclass(frozen=True)
class HorizonRules:
    """What does not change from horizon to horizon.

    `slot_count` is N; `reserve` the share of the energy left that is only spent on least powers,
    for a future that turns out dearer than predicted.
    """

    slot_count: int
    channel: Channel
    radio: Radio
    reserve: float = 0.0


def plan_horizon(
    adjacency: Adjacency,
    intervals: PowerIntervals,
    positions_m: Array,
    left_j: dict[str, float],
    rules: HorizonRules,
) -> HorizonPower:
    """Best powers of a horizon.

    `positions_m` is (slots, UAVs, 3) in the order of `adjacency.uav_ids`. A horizon that ends
    before slot N may use its share of the energy left, but never less than its least powers cost;
    at slot N and on the way home the least powers are all that is spent. The current slot costs
    energy like any other. A UAV that cannot pay for its least powers is held as long as it can and
    silent then; the others go on. Raises MessageError if the two records are not of one horizon.
    Source: (P4).
    """
    if adjacency.horizon != intervals.horizon or adjacency.uav_ids != intervals.uav_ids:
        raise MessageError("power_interval", "is not of the same horizon as the adjacency")
    horizon = adjacency.horizon
    gain = rules.channel.gain(pairwise_distances(positions_m))
    low, high, links = intervals.bounds_w[..., 0], intervals.bounds_w[..., 1], adjacency.links
    left = np.array([left_j[uav_id] for uav_id in adjacency.uav_ids])
    floor = low.sum(axis=0) * horizon.duration_s
    slots_left = max(rules.slot_count + 1 - horizon.first, horizon.count)
    share = (1.0 - rules.reserve) * horizon.count / slots_left
    if horizon.first >= rules.slot_count:
        share = 0.0
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
    links, gain, low, high = (np.concatenate([each[:1], each]) for each in (links, gain, low, high))
    problem = PowerProblem(links, gain, low, high, budget, horizon.duration_s, rules.radio)
    best = allocate(problem)
    schedule = PowerSchedule(horizon, adjacency.uav_ids, best.power_w[1:])
    return HorizonPower(schedule, shortage)


def _with_front(array: AnyArray) -> AnyArray:
    return np.concatenate([array[:1], array])


def from_now_on(
    adjacency: Adjacency, intervals: PowerIntervals, now_ns: int
) -> tuple[Adjacency, PowerIntervals]:
    """The slots that are not over yet: a late joiner hears of a horizon that began long ago."""
    horizon = adjacency.horizon
    gone = int((now_ns - horizon.t0_ns) // round(horizon.duration_s * 1e9))
    gone = min(max(gone, 0), horizon.count - 1)
    if not gone:
        return adjacency, intervals
    left = SlotHorizon(
        horizon.first + gone,
        int(horizon.instants_ns[gone]),
        horizon.duration_s,
        horizon.count - gone,
    )
    return (
        Adjacency(left, adjacency.uav_ids, adjacency.links[gone:]),
        PowerIntervals(left, intervals.uav_ids, intervals.bounds_w[gone:]),
    )
