"""Energy that C-TOP's topology costs at the least."""

from __future__ import annotations

from jfto_msgs_py.types import Array
from jfto_topology.ctop import check_degree_rule
from jfto_topology.intervals import power_intervals
from jfto_topology.neighbour_levels import neighbour_levels
from jfto_topology.required_power import checked_caps, required_powers
from jfto_topology.rings import ring_powers
from jfto_topology.trimming import trimmed_lists
from jfto_world.radio import Channel


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
