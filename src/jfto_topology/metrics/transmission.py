"""What the network carries, and what sending costs."""

from __future__ import annotations

import numpy as np

from jfto_msgs_py.records.radio import Radio
from jfto_msgs_py.types import Array, Flags
from jfto_world.radio import rate_bps


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
    """
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
