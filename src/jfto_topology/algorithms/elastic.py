"""C-TOP that uses what δ allows: per slot the topology within [K_min, K_min + δ] that carries most.

Algorithm 2 lists as few neighbours as it must. (P0kmax) allows more, and where every link has
40 dB over the noise, more links carry more.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from jfto_msgs_py.errors import InputError
from jfto_msgs_py.records.topology import ELASTIC, LITERAL
from jfto_msgs_py.types import Array
from jfto_topology.algorithms.affordable import affordable, mixed
from jfto_topology.algorithms.ctop import (
    Topology,
    check_degree_rule,
    ctop_of_gain,
    topology_of_levels,
)
from jfto_topology.algorithms.exchange import Costs, carried, exchanged_links
from jfto_topology.algorithms.intervals import power_intervals, ring_powers
from jfto_topology.algorithms.required_power import checked_caps, required_powers_of_gain


@dataclass(frozen=True, eq=False)
class Air:
    """What powers do in M slots.

    `gain` (M, A, A) is linear; `p_max_w` (A,) are P_a,max, `sensitivity_w` γ and `noise_w` the
    noise in the whole band, all in W.
    """

    gain: Array
    p_max_w: Array
    sensitivity_w: float
    noise_w: float


def ctop_elastic(
    air: Air,
    k_min: int,
    delta: int,
    energy_j: Array | None = None,
    slot_duration_s: float | Array = 1.0,
) -> Topology:
    """Per slot the topology with K_min to K_min + δ listed neighbours that carries most.

    Starts from the best of the topologies that Algorithm 2 gives for K_min … K_min + δ, and
    exchanges links while the sum of rates over listed links grows. Where a UAV cannot pay for all
    slots, the slots in which it saves most give way, one neighbour after the other, down to
    Algorithm 2 for K_min. Source: Algorithm 2 with (P0kmin), (P0kmax).

    Parameters
    ----------
    air
        Gains and powers of M slots.
    k_min, delta
        K_min < A, and the neighbours allowed beyond it, δ ≥ 0.
    energy_j
        Left for all M slots, (A,) in joules; None: enough.
    slot_duration_s
        Δt in s, one for all slots or (M,); 0 for a slot that costs nothing.

    Returns
    -------
    Topology
        As `ctop` gives it; `degree_before_trim` counts what the powers reach.

    Raises
    ------
    InputError
        For arguments that make no sense.
    """
    wishes = elastic_wishes(air, k_min, delta)
    uavs = len(air.p_max_w)
    budget_j = np.full(uavs, np.inf) if energy_j is None else np.asarray(energy_j, dtype=np.float64)
    if budget_j.shape != (uavs,) or np.isnan(budget_j).any():
        raise InputError(f"energy_j has shape {budget_j.shape}, must be joules, ({uavs},).")
    return affordable(wishes, budget_j, slot_duration_s)[0]


def topology_of_form(
    form: str,
    air: Air,
    k_min: int,
    delta: int,
    energy_j: Array | None = None,
    slot_duration_s: float | Array = 1.0,
) -> Topology:
    """C-TOP in one of its forms (`TOPOLOGY_FORMS`); the elastic one alone asks for the energy.

    In the closed form powers go up to the next candidate's own, who may then be heard too: `reach`
    is what the greatest powers make. Source: Algorithm 2, (P4pmin). Raises InputError.
    """
    if form == ELASTIC:
        return ctop_elastic(air, k_min, delta, energy_j, slot_duration_s)
    literal = ctop_of_gain(air.gain, air.p_max_w, air.sensitivity_w, k_min, delta)
    if form == LITERAL:
        return literal
    required_w = required_powers_of_gain(air.gain, air.p_max_w, air.sensitivity_w)
    upper = literal.p_max_w
    reach = required_w <= np.minimum(upper[:, :, None], upper[:, None, :])
    return replace(literal, p_upper_w=upper, reach=reach)


def elastic_wishes(air: Air, k_min: int, delta: int) -> list[Callable[[], Topology]]:
    """The topology that carries most, then Algorithm 2 for K_min + δ … K_min, for `affordable`.

    Raises InputError for arguments that make no sense.
    """
    required_w = required_powers_of_gain(air.gain, air.p_max_w, air.sensitivity_w)
    uavs = required_w.shape[1]
    check_degree_rule(k_min, delta, uavs)
    if not (air.noise_w > 0 and np.isfinite(air.noise_w)):
        raise InputError(f"noise_w is {air.noise_w}, must be positive watts.")
    caps_w = checked_caps(air.p_max_w, uavs)
    ring_w = ring_powers(required_w)
    most = min(k_min + delta, max(uavs - 1, 0))
    # Each rung lists one neighbour more at least, where there are so many.
    rungs = [
        topology_of_levels(required_w, ring_w, caps_w, wanted, (k_min, delta))
        for wanted in range(most, k_min - 1, -1)
    ]
    deficit = rungs[-1].deficit
    rungs = [replace(rung, deficit=deficit) for rung in rungs]
    costs = Costs(required_w, ring_w, caps_w, np.ascontiguousarray(air.gain / air.noise_w))
    best = _exchanged(rungs, costs, k_min, k_min + delta)
    return [partial(_given, rung) for rung in (best, *rungs)]


def _given(topology: Topology) -> Topology:
    return topology


def _exchanged(rungs: Sequence[Topology], costs: Costs, k_min: int, most: int) -> Topology:
    """The rung of each slot that carries most, its links exchanged for better ones."""
    bits = np.stack([carried(rung.adjacency, costs) for rung in rungs])
    choice = np.argmax(bits, axis=0)
    start = rungs[0]
    for number, rung in enumerate(rungs[1:], 1):
        start = mixed(start, rung, choice == number)
    active = exchanged_links(start.adjacency, costs, k_min, most)
    low, bound, upper, reach = power_intervals(costs.required_w, costs.ring_w, active, costs.caps_w)
    return replace(
        start,
        adjacency=active,
        reach=reach,
        p_min_w=low,
        p_max_w=bound,
        p_upper_w=upper,
        over_degree=active.sum(axis=2) > most,
        degree_before_trim=reach.sum(axis=2),
    )
