"""What the network carries."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from jfto_msgs_py.radio import Radio
from jfto_msgs_py.types import Array
from jfto_world.radio import rate_bps


def slot_throughput(
    adjacency: NDArray[np.bool_], gain: Array, power_w: Array, radio: Radio
) -> Array:
    """Network throughput of each slot in bit/s, (M,).

    `adjacency` and `gain` are (M, A, A), `power_w` (M, A). Each linked unordered pair counts with
    the mean of its two directions: half duplex, equal shares.
    """
    rate = np.where(adjacency, rate_bps(radio, power_w[:, :, None], gain), 0.0)
    return rate.sum(axis=(1, 2)) / 2


def total_throughput(
    adjacency: NDArray[np.bool_], gain: Array, power_w: Array, radio: Radio
) -> float:
    """Sum of the slot throughputs over n = 1..N in bit/s (P0obj); arrays hold n = 0..N.

    Divided by N it is the mean throughput, times Δt the bits that the mission can carry.
    """
    return float(slot_throughput(adjacency[1:], gain[1:], power_w[1:], radio).sum())
