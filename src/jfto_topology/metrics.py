"""Numbers by which topologies are compared: components, hops, throughput and energy."""

from __future__ import annotations

import numpy as np

from jfto_msgs_py.errors import InputError
from jfto_msgs_py.records.radio import Radio
from jfto_msgs_py.types import Array, Flags, Ints
from jfto_world.compiled import kernel
from jfto_world.radio import rate_bps


def connectivity_rate(adjacency: Flags, first_slot: int, on_air: Flags | None = None) -> float:
    """ξ: mean share of the survivors that stay in one component when one UAV is lost.

    Each UAV in turn is gone from n_DC to N, powers staying as planned:
    ξ = Σ_a Σ_n AC_a(n)/(A - 1) / (A (N - n_DC + 1)), AC being the size of the largest component.

    Parameters
    ----------
    adjacency
        Links (N + 1, A, A), symmetric.
    first_slot
        n_DC, the first slot that counts.
    on_air
        (N + 1, A), marks UAVs with energy left; one off the air counts as lost too. None: all.

    Returns
    -------
    float
        ξ, from 0 to 1; 1 for a fleet of one, of which nobody is left to be cut off.

    Raises
    ------
    InputError
        For a slot beyond the plan.
    """
    slots, uavs = adjacency.shape[:2]
    if not 0 <= first_slot < slots:
        raise InputError(f"first_slot is {first_slot}, must be from 0 to {slots - 1}.")
    if uavs < 2:
        return 1.0
    alive = np.ones((slots, uavs), dtype=np.bool_) if on_air is None else on_air
    survivors = np.repeat(alive[first_slot:, None, :], uavs, axis=1)
    survivors[:, np.arange(uavs), np.arange(uavs)] = False
    links = np.ascontiguousarray(adjacency[first_slot:])
    sizes = np.stack([largest_component(links, survivors[:, a]) for a in range(uavs)])
    return float(sizes.mean() / (uavs - 1))


def largest_component(adjacency: Flags, present: Flags) -> Ints:
    """Size of the largest component among the UAVs present.

    Parameters
    ----------
    adjacency
        (M, A, A), symmetric.
    present
        (M, A).

    Returns
    -------
    array of int
        (M,); 0 where nobody is.
    """
    label = components(adjacency, present)
    counts = (label[:, :, None] == np.arange(label.shape[1])).sum(axis=1)
    return counts.max(axis=1, initial=0)


def components(adjacency: Flags, present: Flags) -> Ints:
    """Component of each UAV present, numbered from 0 in order of lowest index.

    Parameters
    ----------
    adjacency
        (M, A, A), symmetric.
    present
        (M, A).

    Returns
    -------
    array of int
        (M, A); -1 where a UAV is absent.
    """
    label = np.full(present.shape, -1, dtype=np.int64)
    stack = np.empty(present.shape[1], dtype=np.int64)
    _label(np.ascontiguousarray(adjacency), np.ascontiguousarray(present), label, stack)
    return label


@kernel
def _label(adjacency: Flags, present: Flags, label: Ints, stack: Ints) -> None:
    """Walk through each component of every slot; `stack` (A,) is room to work in."""
    slots, uavs = present.shape
    for m in range(slots):
        count = 0
        for seed in range(uavs):
            if label[m, seed] >= 0 or not present[m, seed]:
                continue
            label[m, seed] = count
            stack[0] = seed
            depth = 1
            while depth > 0:
                depth -= 1
                a = stack[depth]
                for b in range(uavs):
                    if adjacency[m, a, b] and present[m, b] and label[m, b] < 0:
                        label[m, b] = count
                        stack[depth] = b
                        depth += 1
            count += 1


def average_hops(adjacency: Flags) -> float:
    """Mean shortest-path length over ordered pairs and slots; inf if any slot is disconnected.

    Parameters
    ----------
    adjacency
        Links (M, A, A), symmetric.

    Returns
    -------
    float
        Links on the way, 0 for a single UAV.

    Raises
    ------
    InputError
        `adjacency` has another shape.
    """
    _check_square(adjacency)
    hops = hop_counts(adjacency)
    pairs = hops.shape[0] * hops.shape[1] * (hops.shape[1] - 1)
    if not pairs:
        return 0.0
    # The diagonal is 0, and -1 marks a pair without a path.
    return float("inf") if (hops < 0).any() else float(hops.sum() / pairs)


def _check_square(adjacency: Flags) -> None:
    if adjacency.ndim != 3 or adjacency.shape[1] != adjacency.shape[2]:
        raise InputError(f"adjacency has shape {adjacency.shape}, must be (slots, UAVs, UAVs).")


def hop_counts(adjacency: Flags) -> Ints:
    """Links on the shortest path between all pairs.

    Parameters
    ----------
    adjacency
        (M, A, A), symmetric.

    Returns
    -------
    array of int
        (M, A, A); -1 where there is no path.
    """
    hops = np.full(adjacency.shape, -1, dtype=np.int64)
    _walk(np.ascontiguousarray(adjacency), hops, np.empty(adjacency.shape[1], dtype=np.int64))
    return hops


@kernel
def _walk(adjacency: Flags, hops: Ints, queue: Ints) -> None:
    """Walk from every UAV of every slot, nearest first; `queue` (A,) is room to work in."""
    slots, uavs, _ = adjacency.shape
    for m in range(slots):
        for origin in range(uavs):
            hops[m, origin, origin] = 0
            queue[0] = origin
            head, tail = 0, 1
            while head < tail:
                a = queue[head]
                head += 1
                for b in range(uavs):
                    if adjacency[m, a, b] and hops[m, origin, b] < 0:
                        hops[m, origin, b] = hops[m, origin, a] + 1
                        queue[tail] = b
                        tail += 1


def slot_throughput(adjacency: Flags, gain: Array, power_w: Array, radio: Radio) -> Array:
    """Network throughput of each slot in bit/s, (M,).

    Each linked unordered pair counts with the mean of its two directions: half duplex, equal
    shares.

    Parameters
    ----------
    adjacency, gain
        Links and linear gains (M, A, A).
    power_w
        Powers (M, A) in W.
    radio
        Bandwidth and noise.

    Returns
    -------
    Array
        (M,), bit/s.

    Raises
    ------
    InputError
        Shapes do not fit together, or a power is negative.
    """
    _check_square(adjacency)
    if gain.shape != adjacency.shape or power_w.shape != adjacency.shape[:2]:
        raise InputError(
            f"gain has shape {gain.shape} and power_w {power_w.shape}, must be {adjacency.shape} "
            f"and {adjacency.shape[:2]}."
        )
    if (power_w < 0).any():
        raise InputError("power_w holds negative values, must be W from 0.")
    rate = np.where(adjacency, rate_bps(radio, power_w[:, :, None], gain), 0.0)
    return rate.sum(axis=(1, 2)) / 2


def energy_used(power_w: Array, slot_duration_s: float) -> Array:
    """Σ_{n=1..N} p Δt of each UAV (P0emax).

    Parameters
    ----------
    power_w
        p (N + 1, A), W.
    slot_duration_s
        Δt, s.

    Returns
    -------
    array of float
        (A,), J.
    """
    return power_w[1:].sum(axis=0) * slot_duration_s
