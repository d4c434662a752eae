"""What the network carries, what sending costs, and whether it lasts."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from jfto_msgs_py.records.radio import Radio
from jfto_msgs_py.types import Array
from jfto_world.radio import rate_bps


def slot_throughput(
    adjacency: NDArray[np.bool_], gain: Array, power_w: Array, radio: Radio
) -> Array:
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


def total_throughput(
    adjacency: NDArray[np.bool_], gain: Array, power_w: Array, radio: Radio
) -> float:
    """Sum of the slot throughputs over n = 1..N in bit/s (P0obj); arrays hold n = 0..N.

    Divided by N it is the mean throughput, times Δt the bits that the mission can carry.
    """
    return float(slot_throughput(adjacency[1:], gain[1:], power_w[1:], radio).sum())


def energy_used(power_w: Array, slot_duration_s: float) -> Array:
    """Σ_{n=1..N} p Δt of each UAV in joules (A,); `power_w` is (N + 1, A) (P0emax)."""
    return power_w[1:].sum(axis=0) * slot_duration_s


def first_unpaid_slot(on_air: NDArray[np.bool_]) -> NDArray[np.int64]:
    """First slot in which each UAV is off the air, (A,); N + 1 if it lasts to the end.

    `on_air` is (N + 1, A).
    """
    return np.where(on_air.all(axis=0), on_air.shape[0], np.argmin(on_air, axis=0))


def traverses_all(on_air: NDArray[np.bool_]) -> bool:
    """Whether every UAV is still on the air at the end: one without a link must break off."""
    return bool(on_air.all())
