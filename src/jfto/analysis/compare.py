"""Topology, power and metrics of a plan under all four algorithms."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from jfto.analysis.comparison import ALGORITHMS, OURS, AlgorithmResult, Comparison, LinkMetrics
from jfto.console.progress import Watcher
from jfto.planning.network import Network, network_of
from jfto_msgs_py.plan import Plan
from jfto_msgs_py.types import Array, Flags
from jfto_power.allocation import Allocation, allocate, allocate_prefix
from jfto_power.shortage import EnergyShortage
from jfto_topology.a_lmst import a_lmst
from jfto_topology.cpapo import cpapo
from jfto_topology.ctop import Topology, ctop
from jfto_topology.metrics import average_hops, connectivity_rate, energy_used, slot_throughput
from jfto_topology.mtp import mtp
from jfto_topology.powered import PoweredTopology
from jfto_world.radio import degrees


def compare(plan: Plan, n_dc: int, watcher: Watcher) -> Comparison:
    """All algorithms on the plan's positions and budgets; raises InputError."""
    network = network_of(plan)
    watcher.begin("topology", "C-TOP")
    topology = ctop(
        network.positions_m,
        network.channel,
        network.p_max_w,
        network.sensitivity_w,
        plan.k_min,
        plan.delta,
    )
    notes = _topology_notes(plan, topology)
    degree = degrees(topology.adjacency)
    watcher.end(
        "topology",
        f"{plan.slots.count} slots",
        f"degree {_span(degree.min(), degree.max())}, "
        + ("always connected" if topology.connected.all() else "not always connected")
        + (f", δ exceeded {topology.over_degree.sum()} ×" if topology.over_degree.any() else ""),
        good=bool(topology.connected.all() and not topology.deficit.any()),
    )
    watcher.begin("power", "exact allocation")
    allocation = _allocate(plan, network, topology, notes)
    ours = _ours(plan, network, topology, allocation, n_dc)
    share = 100 * ours.energy_j / network.energy_j
    watcher.end(
        "power",
        f"{ours.linked.mean_throughput_mbps:.4g} Mb/s",
        f"energy {_span(round(share.min()), round(share.max()))} % of budget",
        good=ours.traverses_all,
    )
    watcher.begin("compare", "MTP, A-LMST, CPAPO")
    results = [*_baselines(plan, network, n_dc), ours]
    watcher.end("compare", "4 algorithms", _ratios(results))
    return Comparison(
        results=tuple(sorted(results, key=lambda result: ALGORITHMS.index(result.name))),
        gain=network.gain,
        n_dc=n_dc,
        notes=tuple(notes),
    )


def _allocate(plan: Plan, network: Network, topology: Topology, notes: list[str]) -> Allocation:
    """Best powers; where the energy does not last, those of the longest prefix that it does."""
    try:
        return allocate(
            topology.adjacency,
            network.gain,
            topology.p_min_w,
            topology.p_upper_w,
            network.energy_j,
            plan.slots.duration_s,
            plan.radio,
            names=tuple(uav.id for uav in plan.uavs),
        )
    except EnergyShortage as shortage:
        notes.append(str(shortage))
        return allocate_prefix(
            topology.adjacency,
            network.gain,
            topology.p_min_w,
            topology.p_upper_w,
            network.energy_j,
            plan.slots.duration_s,
            plan.radio,
        )


def _ours(
    plan: Plan, network: Network, topology: Topology, allocation: Allocation, n_dc: int
) -> AlgorithmResult:
    held = np.arange(plan.slots.count + 1) <= allocation.slots_held
    on_air = np.broadcast_to(held[:, None], allocation.power_w.shape)
    weaker_w = np.minimum(allocation.power_w[:, :, None], allocation.power_w[:, None, :])
    # The topology knows exactly which pairs hear each other; a power at a bound must not decide
    # that anew by its last bit.
    linked = topology.reach & (weaker_w > 0)
    active = topology.adjacency & held[:, None, None]
    return _result(plan, network, OURS, linked, active, allocation.power_w, on_air, n_dc)


def _baselines(plan: Plan, network: Network, n_dc: int) -> list[AlgorithmResult]:
    shared = (network.positions_m, network.channel, network.p_max_w, network.sensitivity_w)
    budget = (network.energy_j, plan.slots.duration_s)
    powered: dict[str, PoweredTopology] = {
        "MTP": mtp(*shared, *budget),
        "A-LMST": a_lmst(*shared, *budget, network.speed_mps),
        "CPAPO": cpapo(*shared, *budget),
    }
    return [
        _result(plan, network, name, one.adjacency, one.listed, one.power_w, one.on_air, n_dc)
        for name, one in powered.items()
    ]


def _result(
    plan: Plan,
    network: Network,
    name: str,
    linked: Flags,
    active: Flags,
    power_w: Array,
    on_air: Flags,
    n_dc: int,
) -> AlgorithmResult:
    def metrics(links: Flags) -> LinkMetrics:
        return LinkMetrics(
            links=links,
            throughput_bps=slot_throughput(links, network.gain, power_w, plan.radio),
            connectivity_rate=connectivity_rate(links, n_dc, on_air),
            hops=average_hops(links),
        )

    return AlgorithmResult(
        name=name,
        linked=metrics(linked),
        active=metrics(active),
        power_w=power_w,
        degree=degrees(active),
        energy_j=energy_used(power_w, plan.slots.duration_s),
        traverses_all=bool(on_air.all()),
    )


def _topology_notes(plan: Plan, topology: Topology) -> list[str]:
    """What C-TOP could not keep, per UAV with the slots."""
    notes = []
    for flags, text in (
        (topology.deficit, f"has fewer than {plan.k_min} neighbours within reach"),
        (topology.over_degree, f"cannot spare a neighbour beyond {plan.k_min + plan.delta}"),
    ):
        for index, uav in enumerate(plan.uavs):
            slots = np.flatnonzero(flags[:, index])
            if slots.size:
                notes.append(f"{uav.id} {text} in {_slots_text(slots)}.")
    apart = np.flatnonzero(~topology.connected)
    if apart.size:
        notes.append(f"The fleet is not connected in {_slots_text(apart)}.")
    return notes


def _span(low: int, high: int) -> str:
    return f"{low}" if low == high else f"{low}–{high}"


def _slots_text(slots: NDArray[np.intp]) -> str:
    """Slots as ranges: "slot 3", "slots 3–5, 9"."""
    runs = np.split(slots, np.flatnonzero(np.diff(slots) > 1) + 1)
    texts = [f"{run[0]}" if len(run) == 1 else f"{run[0]}–{run[-1]}" for run in runs]
    return f"slot{'s' if len(slots) > 1 else ''} {', '.join(texts)}"


def _ratios(results: list[AlgorithmResult]) -> str:
    ours = results[-1].linked.mean_throughput_mbps
    others = (
        f"{ours / other.linked.mean_throughput_mbps:.2f} × {other.name}" for other in results[:-1]
    )
    return "throughput " + ", ".join(others)
