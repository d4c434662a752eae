"""Power intervals for a topology that somebody else chose."""

from __future__ import annotations

import numpy as np

from jfto_msgs_py.types import Array, Flags
from jfto_topology.intervals import power_intervals
from jfto_topology.required_power import checked_caps, required_powers
from jfto_topology.rings import ring_powers
from jfto_world.radio import Channel


def kept_intervals(
    adjacency: Flags, positions_m: Array, channel: Channel, p_max_w: Array, sensitivity_w: float
) -> tuple[Array, Array]:
    """Least and greatest safe powers (M, A) that keep the links of `adjacency` (M, A, A).

    As C-TOP does for its own links, so that a baseline's topology can be given the exact power
    allocation too. Links that are out of reach at P_a,max are left out.
    """
    required_w = required_powers(positions_m, channel, p_max_w, sensitivity_w)
    active = np.ascontiguousarray(adjacency & np.isfinite(required_w))
    caps_w = checked_caps(p_max_w, required_w.shape[1])
    low, _, upper, _ = power_intervals(required_w, ring_powers(required_w), active, caps_w)
    return low, upper
