"""CPAPO, reconstructed: powers lowered in turn as far as a backbone allows."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from jfto_msgs_py.types import Array, Flags
from jfto_topology.algorithms.backbone import backbones
from jfto_topology.algorithms.powered import PoweredTopology, played_out
from jfto_topology.algorithms.required_power import required_powers
from jfto_world.compiled import allocating_kernel as kernel
from jfto_world.radio import Channel


def cpapo(
    positions_m: Array,
    channel: Channel,
    p_max_w: Array,
    sensitivity_w: float,
    energy_j: ArrayLike,
    slot_duration_s: float,
) -> PoweredTopology:
    """Cyclic pruning from P_a,max around a connected dominating set, in every slot.

    `positions_m` is (M, A, 3), `p_max_w` and `energy_j` (A,). A UAV that runs out of energy goes
    off the air. Raises InputError as `ctop` does. The rules and what is not known of the original:
    docs/explanation/baselines.md.
    """
    required_w = required_powers(positions_m, channel, p_max_w, sensitivity_w)
    possible = np.isfinite(required_w)
    links = pruned_links(required_w, backbones(possible))
    wanted_w = np.where(links, required_w, 0.0).max(axis=2, initial=0.0)
    return played_out(required_w, wanted_w, links, energy_j, slot_duration_s)


@kernel
def pruned_links(required_w: Array, backbone: Flags) -> Flags:
    """Links (M, A, A) left when no UAV can lower its power by one more neighbour.

    `required_w` is (M, A, A), inf where no link is possible; `backbone` (M, A) marks its members.
    Each cycle lets every UAV in turn drop its farthest neighbour, which is what one step less power
    does, if the backbone stays connected and every other UAV keeps a link to it; cycles end when
    one changes nothing.
    """
    slots, uavs, _ = required_w.shape
    kept = np.zeros((slots, uavs, uavs), dtype=np.bool_)
    for m in range(slots):
        links = kept[m]
        for a in range(uavs):
            for b in range(uavs):
                links[a, b] = required_w[m, a, b] < np.inf
        # Links only ever go: a UAV that must keep its farthest neighbour must keep it for good.
        done = np.zeros(uavs, dtype=np.bool_)
        while not done.all():
            for a in range(uavs):
                if not done[a]:
                    done[a] = not _step_down(required_w[m], links, backbone[m], a)
    return kept


@kernel
def _step_down(required: Array, links: Flags, member: Flags, a: int) -> bool:
    """Drop a's farthest neighbour, the higher index of equals; False if it has to stay."""
    far = -1
    for b in range(links.shape[0]):
        if links[a, b] and (far < 0 or required[a, b] >= required[a, far]):
            far = b
    if far < 0:
        return False
    links[a, far] = links[far, a] = False
    if member[a] and member[far]:
        fine = _joined(links, member, a, far)
    else:
        fine = _served(links, member, a) and _served(links, member, far)
    if not fine:
        links[a, far] = links[far, a] = True
    return fine


@kernel
def _served(links: Flags, member: Flags, a: int) -> bool:
    """Whether a belongs to the backbone or has a link to it."""
    if member[a]:
        return True
    return bool((links[a] & member).any())


@kernel
def _joined(links: Flags, member: Flags, a: int, b: int) -> bool:
    """Whether a backbone member reaches another over members only."""
    uavs = links.shape[0]
    seen = np.zeros(uavs, dtype=np.bool_)
    stack = np.empty(uavs, dtype=np.int64)
    seen[a] = True
    stack[0] = a
    depth = 1
    while depth > 0:
        depth -= 1
        c = stack[depth]
        for d in range(uavs):
            if links[c, d] and member[d] and not seen[d]:
                if d == b:
                    return True
                seen[d] = True
                stack[depth] = d
                depth += 1
    return False
