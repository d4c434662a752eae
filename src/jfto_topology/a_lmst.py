"""A-LMST, reconstructed: local trees that allow for motion until the next refresh."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from jfto_msgs_py.errors import InputError
from jfto_msgs_py.types import Array
from jfto_topology.lmst import lmst_links
from jfto_topology.powered import PoweredTopology, played_out
from jfto_topology.required_power import checked_caps, required_powers
from jfto_world.radio import Channel, pairwise_distances


def a_lmst(
    positions_m: Array,
    channel: Channel,
    p_max_w: Array,
    sensitivity_w: float,
    energy_j: ArrayLike,
    slot_duration_s: float,
    speed_mps: ArrayLike,
) -> PoweredTopology:
    """LMST with G+ in every slot, each kept link served over the distance it may grow to.

    `positions_m` is (M, A, 3), `p_max_w`, `energy_j` and `speed_mps` (A,). Within a slot the two
    ends of a link may part by (v_a + v_b) Δt; a UAV transmits so that its farthest kept neighbour
    still hears it then, at most P_a,max. A UAV that runs out of energy goes off the air. Raises
    InputError as `ctop` does. The rules and what is not known of the original: docs/baselines.md.
    """
    required_w = required_powers(positions_m, channel, p_max_w, sensitivity_w)
    caps_w = checked_caps(p_max_w, required_w.shape[1])
    speed = np.asarray(speed_mps, dtype=np.float64)
    if speed.shape != caps_w.shape or not ((speed >= 0) & np.isfinite(speed)).all():
        raise InputError(f"speed_mps is {speed.tolist()}, must be one speed from 0 per UAV.")
    kept = lmst_links(required_w)
    apart_m = pairwise_distances(positions_m) + (speed[:, None] + speed) * slot_duration_s
    moved_w = channel.required_power(apart_m, sensitivity_w)
    served_w = np.where(kept, np.maximum(moved_w, required_w), 0.0)
    wanted_w = np.minimum(served_w.max(axis=2, initial=0.0), caps_w)
    return played_out(required_w, wanted_w, kept, energy_j, slot_duration_s)
