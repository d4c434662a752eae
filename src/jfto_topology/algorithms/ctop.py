"""C-TOP: who is whose neighbour in every slot, and which powers make it so."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from jfto_msgs_py.errors import InputError
from jfto_msgs_py.types import Array, Flags
from jfto_msgs_py.whole_numbers import whole_number
from jfto_topology.algorithms.intervals import power_intervals, ring_powers
from jfto_topology.algorithms.neighbour_levels import neighbour_levels
from jfto_topology.algorithms.required_power import (
    checked_caps,
    required_powers,
    required_powers_of_gain,
)
from jfto_topology.algorithms.trimming import trimmed_lists
from jfto_world.radio import Channel


@dataclass(frozen=True)
class Topology:
    """Topology of M slots and the powers that keep it. Nothing is on the diagonals.

    `adjacency` (M, A, A) holds the active links, that both ends list; `reach` (M, A, A) all pairs
    that hear each other at any powers inside the intervals, a superset of it. Powers lie in
    [`p_min_w`, `p_max_w`), or up to P_a,max inclusive where no other UAV is in reach;
    `p_upper_w` is the greatest power that is safe either way; all (M, A).

    Flags: `deficit` (M, A), fewer than K_min candidates even at P_max; `over_degree` (M, A), more
    than K_min + δ neighbours that cannot be spared; `connected` (M,), one component.
    `degree_before_trim` (M, A) is the number of neighbours that Algorithm 2 gave before trimming.
    """

    adjacency: Flags
    reach: Flags
    p_min_w: Array
    p_max_w: Array
    p_upper_w: Array
    deficit: Flags
    over_degree: Flags
    connected: Flags
    degree_before_trim: NDArray[np.int64]


def ctop(
    positions_m: Array,
    channel: Channel,
    p_max_w: Array,
    sensitivity_w: float,
    k_min: int,
    delta: int,
) -> Topology:
    """Topology and power intervals of every slot.

    Source: Algorithm 2 with eqs Pmin1, Pmax1.

    Parameters
    ----------
    positions_m
        (M, A, 3), ENU metres.
    channel
        Gain between two places.
    p_max_w
        Greatest powers (A,) in W, P_a,max.
    sensitivity_w
        Received power that makes a link, γ in W.
    k_min
        Least neighbours, K_min < A.
    delta
        Neighbours allowed beyond K_min, δ ≥ 0.

    Returns
    -------
    Topology
        A fleet that is too far apart is not an error: its slots and UAVs are flagged.

    Raises
    ------
    InputError
        For arguments that make no sense.
    """
    required_w = required_powers(positions_m, channel, p_max_w, sensitivity_w)
    return _from_required(required_w, p_max_w, k_min, delta)


def ctop_of_gain(
    gain: Array, p_max_w: Array, sensitivity_w: float, k_min: int, delta: int
) -> Topology:
    """As `ctop`, from linear link gains (M, A, A) instead of positions."""
    required_w = required_powers_of_gain(gain, p_max_w, sensitivity_w)
    return _from_required(required_w, p_max_w, k_min, delta)


def _from_required(required_w: Array, p_max_w: Array, k_min: int, delta: int) -> Topology:
    uav_count = required_w.shape[1]
    check_degree_rule(k_min, delta, uav_count)
    caps_w = checked_caps(p_max_w, uav_count)
    ring_w = ring_powers(required_w)
    return topology_of_levels(required_w, ring_w, caps_w, k_min, (k_min, delta))


def topology_of_levels(
    required_w: Array, ring_w: Array, caps_w: Array, wanted: int, degree_rule: tuple[int, int]
) -> Topology:
    """Algorithm 2 that begins with `wanted` neighbours; the degree rule is K_min and δ.

    Powers that links cost are (M, A, A), caps (A,), all in W.
    """
    level_w, deficit, connected = neighbour_levels(required_w, ring_w, wanted)
    active, before, over = trimmed_lists(required_w, ring_w, level_w, *degree_rule)
    low, bound, upper, reach = power_intervals(required_w, ring_w, active, caps_w)
    return Topology(active, reach, low, bound, upper, deficit, over, connected, before)


def check_degree_rule(k_min: int, delta: int, uav_count: int) -> None:
    """Raise InputError unless 0 ≤ K_min < A and δ ≥ 0, both whole."""
    whole_number("k_min", k_min)
    whole_number("delta", delta)
    if not 0 <= k_min < uav_count:
        raise InputError(
            f"k_min is {k_min}, must be from 0 to {uav_count - 1}: each of {uav_count} UAVs has "
            "only the others as neighbours."
        )
    if delta < 0:
        raise InputError(f"delta is {delta}, must not be negative.")


def energy_floor(
    positions_m: Array,
    slot_duration_s: float,
    *,
    channel: Channel,
    p_max_w: Array,
    sensitivity_w: float,
    k_min: int,
    delta: int,
) -> Array:
    """Σ P̃min Δt over n = 1..N of each UAV, in joules (A,).

    `positions_m` is (N + 1, A, 3); slot 0 costs nothing. Equals what `ctop` gives, without the
    parts that a search does not need. Raises InputError as `ctop` does. Source: (P0emax).
    """
    required_w = required_powers(positions_m[1:], channel, p_max_w, sensitivity_w)
    uav_count = required_w.shape[1]
    check_degree_rule(k_min, delta, uav_count)
    ring_w = ring_powers(required_w)
    level_w, _, _ = neighbour_levels(required_w, ring_w, k_min)
    active, before, _ = trimmed_lists(required_w, ring_w, level_w, k_min, delta)
    if before.max(initial=0) > k_min + delta:
        level_w = power_intervals(required_w, ring_w, active, checked_caps(p_max_w, uav_count))[0]
    return level_w.sum(axis=0) * slot_duration_s
