"""Local minimum spanning trees: each UAV keeps its neighbours in the tree of those it can hear."""

from __future__ import annotations

import numpy as np

from jfto_msgs_py.types import Array, Flags
from jfto_world.compiled import allocating_kernel as kernel


@kernel
def lmst_links(required_w: Array) -> Flags:
    """Links of LMST with G+, (M, A, A): kept by at least one end.

    `required_w` is (M, A, A), inf where no link is possible. Every UAV builds Prim's tree over its
    visible neighbourhood, itself included, and keeps the UAVs one hop from it in the tree. Links
    are ordered by (power, lower index, higher index), without which the proof of connectivity
    fails. Source: Li, Hou, Sha, "Design and analysis of an MST-based topology control algorithm".
    """
    slots, uavs, _ = required_w.shape
    kept = np.zeros((slots, uavs, uavs), dtype=np.bool_)
    parent = np.empty(uavs, dtype=np.int64)
    waiting = np.empty(uavs, dtype=np.bool_)
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
    return kept


@kernel
def _before(required: Array, a: int, b: int, c: int, d: int) -> bool:
    """Whether link ab comes before link cd in the one order that all UAVs agree on."""
    if required[a, b] != required[c, d]:
        return required[a, b] < required[c, d]
    if min(a, b) != min(c, d):
        return min(a, b) < min(c, d)
    return max(a, b) < max(c, d)
