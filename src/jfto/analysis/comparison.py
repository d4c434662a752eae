"""What the topology algorithms make of one plan."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from jfto.console.progress import SILENT, Progress
from jfto.planning.network import Network, network_of, power_of, topology_of
from jfto_msgs_py.records.plan import Plan
from jfto_msgs_py.records.topology import CLOSED, ELASTIC, LITERAL, TOPOLOGY_FORMS
from jfto_msgs_py.types import Array, Flags
from jfto_msgs_py.units import dbm_to_w
from jfto_power.allocation import Allocation
from jfto_topology.algorithms.cpapo import cpapo
from jfto_topology.algorithms.ctop import Topology
from jfto_topology.algorithms.lmst import a_lmst
from jfto_topology.algorithms.mtp import mtp
from jfto_topology.algorithms.powered import PoweredTopology
from jfto_topology.ground_rate import NODE_EXCLUSIVE, ONE_BAND, deaf_uavs, ground_rate
from jfto_topology.metrics import average_hops, connectivity_rate, energy_used, slot_throughput
from jfto_topology.one_band import OneBand, one_band
from jfto_world.radio import degrees, mutual_links, rate_bps

# Rows of C-TOP's forms; the paper has one row, for which each of them is a reading.
FORM_NAMES = {form: f"C-TOP {form}" for form in TOPOLOGY_FORMS}


@dataclass(frozen=True)
class LinkMetrics:
    """What one set of links is worth; slots n = 0 … N on axis 0.

    `links` is (N + 1, A, A); `throughput_bps` (N + 1,) the network throughput of each slot;
    `connectivity_rate` ξ; `hops` the mean shortest path, inf where some slot is disconnected.
    """

    links: Flags
    throughput_bps: Array
    connectivity_rate: float
    hops: float

    @property
    def mean_throughput_mbps(self) -> float:
        """Network throughput in Mb/s, mean over slots 1 … N."""
        return float(self.throughput_bps[1:].mean() / 1e6)


@dataclass(frozen=True)
class GroundRates:
    """Rate that all UAVs can send to the ground stations at once, bit/s, slots 0 … N.

    `own_time_bps` where each radio has its own time only, `one_band_bps` where all share one
    channel; both (N + 1,). `deaf` (N + 1, A) are UAVs without a way to any station.
    """

    own_time_bps: Array
    one_band_bps: Array
    deaf: Flags

    @property
    def mean_mbps(self) -> tuple[float, float]:
        """Both in Mb/s, means over slots 1 … N."""
        own, shared = (
            float(each[1:].mean() / 1e6) for each in (self.own_time_bps, self.one_band_bps)
        )
        return own, shared

    @property
    def deaf_share(self) -> float:
        """Share of UAVs and slots without a way to the ground."""
        return float(self.deaf[1:].mean())


@dataclass(frozen=True)
class AlgorithmResult:
    """One algorithm on one plan.

    `linked` counts every pair that hears each other at the algorithm's powers, the definition of a
    link that is the same for all algorithms; `active` only the links that both ends list, to which
    the neighbour rule applies. `power_w` is (N + 1, A), 0 where a UAV is off the air; `degree`
    (N + 1, A) counts active links; `decades` is the sum of log10(1 + SNR) over linked pairs and
    slots 1 … N, `one_band` what one channel carries of them at once; `ground` is there where the
    plan has ground stations; `energy_j` (A,) is what slots 1 … N cost. `traverses_all` says that no
    UAV runs out of energy before the fleet is done.
    """

    name: str
    linked: LinkMetrics
    active: LinkMetrics
    power_w: Array
    degree: NDArray[np.int64]
    decades: float
    one_band: OneBand
    energy_j: Array
    traverses_all: bool
    ground: GroundRates | None = None

    @property
    def heard(self) -> NDArray[np.int64]:
        """How many each UAV hears and is heard by, listed or not, (N + 1, A)."""
        return degrees(self.linked.links)

    @property
    def spans(self) -> tuple[str, str]:
        """Least and most neighbours, those listed and those heard."""
        listed, heard = (f"{each.min()}–{each.max()}" for each in (self.degree, self.heard))
        return listed, heard


@dataclass(frozen=True)
class Comparison:
    """All algorithms on one plan, in the order of the paper's tables, the forms of C-TOP last.

    `form` is the plan's form of C-TOP. `gain` (N + 1, A, A) holds the linear link gains. `notes`
    say what C-TOP could not keep.
    """

    form: str
    results: tuple[AlgorithmResult, ...]
    gain: Array
    n_dc: int
    notes: tuple[str, ...]

    @property
    def ours(self) -> AlgorithmResult:
        """C-TOP's result in the form that the plan is flown with."""
        return next(result for result in self.results if result.name == FORM_NAMES[self.form])

    @property
    def baselines(self) -> tuple[AlgorithmResult, ...]:
        """The results that are not C-TOP's."""
        return tuple(one for one in self.results if one.name not in FORM_NAMES.values())

    @property
    def throughput_ratios(self) -> dict[str, float]:
        """The throughput of the plan's C-TOP over that of each baseline that has any."""
        ours = self.ours.linked.mean_throughput_mbps
        return {
            result.name: ours / result.linked.mean_throughput_mbps
            for result in self.baselines
            if result.linked.mean_throughput_mbps > 0
        }

    def table(self) -> str:
        """The figures as plain text, one line per algorithm."""
        head = ("Mb/s", "ξ %", "hops", "listed", "heard", "all fly")
        lines = [
            f"{'':13} {head[0]:>9} {head[1]:>7} {head[2]:>6}" + "".join(f"{h:>8}" for h in head[3:])
        ]
        for each in self.results:
            linked = each.linked
            lines.append(
                f"{each.name:13} {linked.mean_throughput_mbps:9.4g} "
                f"{100 * linked.connectivity_rate:7.1f} {linked.hops:6.2f}"
                + "".join(
                    f"{span:>8}" for span in (*each.spans, "yes" if each.traverses_all else "no")
                )
            )
        return "\n".join([*lines, *self.notes])


def compare(plan: Plan, n_dc: int, progress: Progress = SILENT) -> Comparison:
    """All algorithms on the plan's positions and budgets; raises InputError."""
    network = network_of(plan)
    rate = _Rating(plan, network, n_dc)
    name = FORM_NAMES[plan.topology]
    progress.begin("topology", name)
    topology = topology_of(plan, network)
    notes = _topology_notes(plan, topology)
    degree = degrees(topology.adjacency)
    progress.end(
        "topology",
        f"{plan.slots.count} slots",
        f"{name}, degree {_span(degree.min(), degree.max())}, "
        + ("always connected" if topology.connected.all() else "not always connected")
        + (f", δ exceeded {topology.over_degree.sum()} ×" if topology.over_degree.any() else ""),
        good=bool(topology.connected.all() and not topology.deficit.any()),
    )
    progress.begin("power", "exact allocation")
    allocation, shortage = power_of(plan, network, topology)
    notes += [shortage] if shortage else []
    ours = _form(rate, plan.topology, topology, allocation)
    share = 100 * ours.energy_j / network.energy_j
    progress.end(
        "power",
        f"{ours.linked.mean_throughput_mbps:.4g} Mb/s",
        f"energy {_span(round(share.min()), round(share.max()))} % of budget",
        good=ours.traverses_all,
    )
    progress.begin("compare", "MTP, A-LMST, CPAPO, other forms of C-TOP")
    results = (*_baselines(rate), *_other_forms(rate), ours)
    comparison = Comparison(
        plan.topology, results, gain=network.gain, n_dc=n_dc, notes=tuple(notes)
    )
    ratios = [f"{ratio:.2f} × {name}" for name, ratio in comparison.throughput_ratios.items()]
    words = f"throughput {', '.join(ratios)}" if ratios else "no baseline has any throughput"
    progress.end("compare", f"{len(results)} algorithms", words)
    return comparison


@dataclass(frozen=True)
class _Rating:
    """Rates what an algorithm does on one plan."""

    plan: Plan
    network: Network
    n_dc: int

    def result(
        self, name: str, linked: Flags, active: Flags, power_w: Array, on_air: Flags
    ) -> AlgorithmResult:
        """Links (N + 1, A, A) in both senses, powers and who is on the air (N + 1, A), rated."""
        metrics, band_hz = self._metrics(linked, power_w, on_air), self.plan.radio.bandwidth_hz
        return AlgorithmResult(
            name=name,
            linked=metrics,
            active=self._metrics(active, power_w, on_air),
            power_w=power_w,
            degree=degrees(active),
            decades=float(metrics.throughput_bps[1:].sum() / band_hz * np.log10(2.0)),
            one_band=one_band(linked, self.network.gain, power_w, self.plan.radio),
            energy_j=energy_used(power_w, self.plan.slots.duration_s),
            traverses_all=bool(on_air.all()),
            ground=self._ground(linked, power_w) if self.plan.ground_stations else None,
        )

    def _ground(self, linked: Flags, power_w: Array) -> GroundRates:
        """Rates over links between UAVs (N + 1, A, A) and those that stations and UAVs make."""
        plan, network = self.plan, self.network
        slots, uavs = power_w.shape
        stations = plan.ground_stations
        places = np.array([station.position_m for station in stations])
        away_m = np.linalg.norm(network.positions_m[:, :, None] - places, axis=3)
        gain = network.channel.gain(away_m)
        # What the station cannot answer is no link, as between UAVs.
        weaker_w = np.minimum(
            power_w[:, :, None], dbm_to_w(np.array([s.p_max_dbm for s in stations]))
        )
        rate = np.zeros((slots, uavs + len(stations), uavs + len(stations)))
        sent = rate_bps(plan.radio, power_w[:, :, None], network.gain)
        rate[:, :uavs, :uavs] = np.where(linked, sent, 0.0)
        sent = rate_bps(plan.radio, power_w[:, :, None], gain)
        rate[:, :uavs, uavs:] = np.where(weaker_w * gain >= network.sensitivity_w, sent, 0.0)
        count = len(stations)
        return GroundRates(
            ground_rate(rate, count, NODE_EXCLUSIVE),
            ground_rate(rate, count, ONE_BAND),
            deaf_uavs(rate > 0, count),
        )

    def _metrics(self, links: Flags, power_w: Array, on_air: Flags) -> LinkMetrics:
        return LinkMetrics(
            links=links,
            throughput_bps=slot_throughput(links, self.network.gain, power_w, self.plan.radio),
            connectivity_rate=connectivity_rate(links, self.n_dc, on_air),
            hops=average_hops(links),
        )


def _form(rate: _Rating, form: str, topology: Topology, allocation: Allocation) -> AlgorithmResult:
    held = np.arange(rate.plan.slots.count + 1) <= allocation.slots_held
    on_air = np.broadcast_to(held[:, None], allocation.power_w.shape)
    weaker_w = np.minimum(allocation.power_w[:, :, None], allocation.power_w[:, None, :])
    # The topology knows which pairs hear each other; a power at a bound must not decide that anew
    # by its last bit. Only in the closed form powers decide.
    linked = topology.reach & (weaker_w > 0)
    if form == CLOSED:
        linked &= mutual_links(rate.network.gain, allocation.power_w, rate.network.sensitivity_w)
        linked |= topology.adjacency & (weaker_w > 0)
    active = topology.adjacency & held[:, None, None]
    return rate.result(FORM_NAMES[form], linked, active, allocation.power_w, on_air)


def _other_forms(rate: _Rating) -> list[AlgorithmResult]:
    """The forms of C-TOP that the plan is not flown with, each with its best powers."""
    found = []
    for form in (LITERAL, CLOSED, ELASTIC):
        if form != rate.plan.topology:
            topology = topology_of(rate.plan, rate.network, form)
            allocation, _ = power_of(rate.plan, rate.network, topology)
            found.append(_form(rate, form, topology, allocation))
    return found


def _baselines(rate: _Rating) -> list[AlgorithmResult]:
    network = rate.network
    shared = (network.positions_m, network.channel, network.p_max_w, network.sensitivity_w)
    budget = (network.energy_j, rate.plan.slots.duration_s)
    powered: dict[str, PoweredTopology] = {
        "MTP": mtp(*shared, *budget),
        "A-LMST": a_lmst(*shared, *budget, network.speed_mps),
        "CPAPO": cpapo(*shared, *budget),
    }
    return [
        rate.result(name, one.adjacency, one.listed, one.power_w, one.on_air)
        for name, one in powered.items()
    ]


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
