"""Who hears whom, and what a link carries."""

from __future__ import annotations

import numpy as np

from jfto_msgs_py.records.radio import Radio
from jfto_msgs_py.types import Array, Flags, Ints
from jfto_msgs_py.units import dbm_to_w


def pairwise_distances(positions_m: Array) -> Array:
    """Distances between all UAVs at every instant.

    `positions_m` has shape (..., A, 3); the result has shape (..., A, A).
    """
    difference = positions_m[..., :, None, :] - positions_m[..., None, :, :]
    return np.sqrt(np.einsum("...k,...k->...", difference, difference))


def mutual_links(gain: Array, power_w: Array, sensitivity_w: float) -> Flags:
    """Adjacency: a and b are linked iff min(p_a, p_b) h_ab ≥ γ (eq. cab, made symmetric).

    `gain` has shape (..., A, A) and `power_w` (..., A); the diagonal of the result is False.
    """
    weaker_w = np.minimum(power_w[..., :, None], power_w[..., None, :])
    linked = weaker_w * gain >= sensitivity_w
    linked[..., np.arange(linked.shape[-1]), np.arange(linked.shape[-1])] = False
    return linked


def degrees(adjacency: Flags) -> Ints:
    """Number of neighbours k_a,n (eq. ka); shape (..., A) from (..., A, A) without self links."""
    return adjacency.sum(axis=-1)


def noise_w(radio: Radio) -> float:
    """Noise power in the whole band, σ²B, in watts, in the radio's reading of `noise_dbm`."""
    power = float(dbm_to_w(radio.noise_dbm))
    return power if radio.noise_reading == "total" else power * radio.bandwidth_hz


def rate_bps(radio: Radio, power_w: Array, gain: Array) -> Array:
    """Capacity R = B log2(1 + p h / σ²B) in bit/s (eq. Rab); arguments broadcast."""
    return radio.bandwidth_hz * np.log1p(power_w * gain / noise_w(radio)) / np.log(2.0)
