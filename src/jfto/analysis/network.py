"""What the network carried as planned and as flown, and what transmitting cost each UAV."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from jfto.analysis.comparison import AlgorithmResult, LinkMetrics
from jfto.analysis.grid import FlownGrid
from jfto.analysis.record import RecordedFlight
from jfto_msgs_py.records.plan import Plan
from jfto_msgs_py.types import Array, Flags
from jfto_msgs_py.units import dbm_to_w
from jfto_topology.metrics import average_hops, connectivity_rate, hop_counts, slot_throughput
from jfto_world.radio import degrees, make_channel, mutual_links, pairwise_distances

MEASURED = "measured by the simulated air"
MODELLED = "computed by the plan's radio model from measured positions and powers in force"
SUMMED = "computed from the powers in force"


@dataclass(frozen=True, eq=False)
class FlownNetwork(LinkMetrics):
    """Links as flown and what they were worth; slots n = 0 … M, M being those flown.

    `links` (M + 1, A, A) are the pairs that heard each other in the middle of a slot at the powers
    in force then, `power_w` (M + 1, A) and `gain` (M + 1, A, A) those of that instant;
    `throughput_bps` (M + 1,) is the mean over each slot. `linked_hops` leaves the unreachable pairs
    of disconnected slots out. `source` is MEASURED or MODELLED.
    """

    power_w: Array
    gain: Array
    linked_hops: float
    source: str

    @property
    def degree(self) -> NDArray[np.int64]:
        """Neighbours per slot and UAV, (M + 1, A)."""
        return degrees(self.links)


def flown_network(flight: RecordedFlight, plan: Plan, grid: FlownGrid, n_dc: int) -> FlownNetwork:
    """Links and throughput as the air reported them, else by the plan's model."""
    power_w = _powers(flight, grid)
    channel = make_channel(plan.radio)
    gain = channel.gain(pairwise_distances(np.nan_to_num(grid.position_m)))
    linked = mutual_links(gain, power_w, float(dbm_to_w(plan.radio.sensitivity_dbm)))
    linked &= grid.present[:, :, None] & grid.present[:, None, :]
    throughput = slot_throughput(linked, gain, power_w, plan.radio)
    source = MODELLED
    rates = flight.air.get("rate")
    if rates is not None:
        rate = rates.at(grid.times_s)
        linked = (rate > 0) & (np.swapaxes(rate, 1, 2) > 0)
        throughput = np.where(linked, rate, 0.0).sum(axis=(1, 2)) / 2
        source = MEASURED
    middles = grid.middles
    links = np.ascontiguousarray(linked[middles])
    on_air = grid.present[middles] & (power_w[middles] > 0)
    return FlownNetwork(
        links=links,
        power_w=power_w[middles],
        gain=gain[middles],
        throughput_bps=grid.by_slot(throughput),
        connectivity_rate=connectivity_rate(links, min(n_dc, grid.slots), on_air),
        hops=average_hops(links),
        linked_hops=_linked_hops(links),
        source=source,
    )


@dataclass(frozen=True, eq=False)
class PlannedAgainstFlown:
    """Mean throughput in Mb/s over the slots that plan and flight share, and their ratio."""

    planned_mbps: float
    achieved_mbps: float

    @property
    def ratio(self) -> float:
        """Achieved over planned; nan where nothing was planned."""
        return self.achieved_mbps / self.planned_mbps if self.planned_mbps else float("nan")

    @property
    def in_words(self) -> str:
        """The ratio in words."""
        if not self.planned_mbps:
            return "no throughput planned"
        return f"{100 * self.ratio:.1f} % of the planned throughput"


def against_plan(planned: AlgorithmResult, network: FlownNetwork) -> PlannedAgainstFlown:
    """Means over slots 1 … N, or those of them that are on record."""
    count = min(len(planned.linked.throughput_bps), len(network.throughput_bps))
    wanted = planned.linked.throughput_bps[1:count]
    got = network.throughput_bps[1:count]
    return PlannedAgainstFlown(float(wanted.mean() / 1e6), float(got.mean() / 1e6))


def _powers(flight: RecordedFlight, grid: FlownGrid) -> Array:
    """Powers in force at each instant, (T, A)."""
    air = flight.air.get("power")
    if air is not None:
        return air.at(grid.times_s)
    return np.stack([flight.powers[uav].at(grid.times_s) for uav in flight.uav_ids], axis=1)


def _linked_hops(links: Flags) -> float:
    if links.shape[-1] == 1:
        return 0.0
    hops = hop_counts(np.ascontiguousarray(links))
    reached = hops > 0
    return float(hops[reached].mean()) if reached.any() else float("inf")


@dataclass(frozen=True)
class EnergyUse:
    """Joules of one UAV from lift-off until the fleet was done, planned and as flown."""

    uav: str
    budget_j: float
    planned_j: float
    used_j: float
    source: str

    @property
    def overdraft_j(self) -> float:
        """What was used beyond the budget, 0 if nothing."""
        return max(self.used_j - self.budget_j, 0.0)


def energy_use(
    flight: RecordedFlight, plan: Plan, planned: AlgorithmResult, end_s: float
) -> tuple[EnergyUse, ...]:
    """Energy of every UAV up to `end_s` seconds after lift-off."""
    drained = flight.air.get("energy")
    found = []
    for index, uav in enumerate(plan.uavs):
        if drained is not None:
            # Counted from what stood on the meter at lift-off.
            began, ended = np.interp([0.0, end_s], drained.times_s, drained.values[:, index])
            used_j, source = float(ended - began), MEASURED
        else:
            steps = flight.powers[uav.id]
            used_j, source = _integral(steps.times_s, steps.power_w, end_s), SUMMED
        found.append(
            EnergyUse(uav.id, uav.energy_j, float(planned.energy_j[index]), used_j, source)
        )
    return tuple(found)


def _integral(times_s: Array, power_w: Array, end_s: float) -> float:
    """Energy of steps of power from 0 to `end_s`."""
    begins = np.clip(times_s, 0.0, end_s)
    ends = np.append(begins[1:], end_s)
    return float((power_w * (ends - begins)).sum())
