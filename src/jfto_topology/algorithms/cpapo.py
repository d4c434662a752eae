"""CPAPO, reconstructed: powers lowered in turn as far as a backbone allows."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from jfto_msgs_py.types import Array, Flags, Ints
from jfto_topology.algorithms.backbone import backbones, mark_joined
from jfto_topology.algorithms.powered import PoweredTopology, played_out
from jfto_topology.algorithms.required_power import required_powers
from jfto_world.compiled import inner, kernel
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

    A UAV that runs out of energy goes off the air. The rules, and what is not known of the
    original, are in docs/explanation/baselines.md.

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
    possible = np.isfinite(required_w)
    links = pruned_links(required_w, backbones(possible))
    wanted_w = np.where(links, required_w, 0.0).max(axis=2, initial=0.0)
    return played_out(required_w, wanted_w, links, energy_j, slot_duration_s)


def pruned_links(required_w: Array, backbone: Flags) -> Flags:
    """Links (M, A, A) left when no UAV can lower its power by one more neighbour.

    `required_w` is (M, A, A), inf where no link is possible; `backbone` (M, A) marks its members.
    Each cycle lets every UAV in turn drop its farthest neighbour, which is what one step less power
    does, if the backbone stays connected and every other UAV keeps a link to it; cycles end when
    one changes nothing.
    """
    kept = required_w < np.inf
    uavs = kept.shape[1]
    done, seen = np.empty((2, uavs), dtype=np.bool_)
    _prune(required_w, kept, backbone, done, seen, np.empty(uavs, dtype=np.int64))
    return kept


@kernel
def _prune(
    required_w: Array, kept: Flags, backbone: Flags, done: Flags, seen: Flags, stack: Ints
) -> None:
    """Take links out of `kept`; the last three arguments (A,) are room to work in."""
    slots, uavs, _ = kept.shape
    for m in range(slots):
        # Links only ever go: a UAV that must keep its farthest neighbour must keep it for good.
        for a in range(uavs):
            done[a] = False
        left = uavs
        while left > 0:
            for a in range(uavs):
                if not done[a] and not _step_down(
                    required_w[m], kept[m], backbone[m], a, seen, stack
                ):
                    done[a] = True
                    left -= 1


@inner
def _step_down(
    required: Array, links: Flags, member: Flags, a: int, seen: Flags, stack: Ints
) -> bool:
    """Drop a's farthest neighbour, the higher index of equals; False if it has to stay."""
    far = -1
    for b in range(links.shape[0]):
        if links[a, b] and (far < 0 or required[a, b] >= required[a, far]):
            far = b
    if far < 0:
        return False
    links[a, far] = links[far, a] = False
    if member[a] and member[far]:
        mark_joined(links, member, a, seen, stack)
        fine = seen[far]
    else:
        fine = _served(links, member, a) and _served(links, member, far)
    if not fine:
        links[a, far] = links[far, a] = True
    return fine


@inner
def _served(links: Flags, member: Flags, a: int) -> bool:
    """Whether a belongs to the backbone or has a link to it."""
    served = member[a]
    for b in range(links.shape[0]):
        served |= links[a, b] and member[b]
    return served
