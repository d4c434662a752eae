"""LMST and A-LMST: each UAV keeps its neighbours in the tree of those that it can hear."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from jfto_msgs_py.errors import InputError
from jfto_msgs_py.types import Array, Flags, Ints
from jfto_topology.algorithms.powered import PoweredTopology, played_out
from jfto_topology.algorithms.required_power import checked_caps, required_powers
from jfto_world.compiled import inner, kernel
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

    Within a slot the two ends of a link may part by (v_a + v_b) Δt; a UAV transmits so that its
    farthest kept neighbour still hears it then, at most P_a,max. A UAV that runs out of energy goes
    off the air. The rules, and what is not known of the original, are in
    docs/explanation/baselines.md.

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
    energy_j
        Energy for transmission (A,), or one for all, in J.
    slot_duration_s
        Δt in seconds.
    speed_mps
        Greatest speeds (A,).

    Returns
    -------
    PoweredTopology
        Links, powers and who is on the air, slot by slot.

    Raises
    ------
    InputError
        For arguments that make no sense.
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


def lmst_links(required_w: Array) -> Flags:
    """Links of LMST with G+, (M, A, A): kept by at least one end.

    `required_w` is (M, A, A), inf where no link is possible. Every UAV builds Prim's tree over its
    visible neighbourhood, itself included, and keeps the UAVs one hop from it in the tree. Links
    are ordered by (power, lower index, higher index), without which the proof of connectivity
    fails. Source: Li, Hou, Sha, "Design and analysis of an MST-based topology control algorithm".
    """
    slots, uavs, _ = required_w.shape
    kept = np.zeros((slots, uavs, uavs), dtype=np.bool_)
    _keep_trees(required_w, kept, np.empty(uavs, dtype=np.int64), np.empty(uavs, dtype=np.bool_))
    return kept


@kernel
def _keep_trees(required_w: Array, kept: Flags, parent: Ints, waiting: Flags) -> None:
    """Mark the links of all trees in `kept`; `parent` and `waiting` (A,) are room to work in."""
    slots, uavs, _ = kept.shape
    for m in range(slots):
        required = required_w[m]
        for u in range(uavs):
            for v in range(uavs):
                waiting[v] = required[u, v] < np.inf
                parent[v] = u
            while True:
                nearest = -1
                for v in range(uavs):
                    if waiting[v] and (
                        nearest < 0 or _before(required, parent[v], v, parent[nearest], nearest)
                    ):
                        nearest = v
                if nearest < 0:
                    break
                waiting[nearest] = False
                if parent[nearest] == u:
                    kept[m, u, nearest] = kept[m, nearest, u] = True
                for v in range(uavs):
                    if waiting[v] and _before(required, nearest, v, parent[v], v):
                        parent[v] = nearest


@inner
def _before(required: Array, a: int, b: int, c: int, d: int) -> bool:
    """Whether link ab comes before link cd in the one order that all UAVs agree on."""
    if required[a, b] != required[c, d]:
        return required[a, b] < required[c, d]
    if min(a, b) != min(c, d):
        return min(a, b) < min(c, d)
    return max(a, b) < max(c, d)
