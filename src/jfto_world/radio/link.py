"""Who hears whom, and what a link carries."""

from __future__ import annotations

import numpy as np

from jfto_msgs_py.records.radio import Radio
from jfto_msgs_py.types import Array, Flags, Ints
from jfto_msgs_py.units import dbm_to_w


def pairwise_distances(positions_m: Array) -> Array:
    """Distances between all UAVs at every instant.

    Parameters
    ----------
    positions_m
        (..., A, 3), m.

    Returns
    -------
    array of float
        (..., A, A), m.
    """
    difference = positions_m[..., :, None, :] - positions_m[..., None, :, :]
    return np.sqrt(np.einsum("...k,...k->...", difference, difference))


def mutual_links(gain: Array, power_w: Array, sensitivity_w: float) -> Flags:
    """Adjacency: a and b are linked iff min(p_a, p_b) h_ab ≥ γ (eq. cab, made symmetric).

    Parameters
    ----------
    gain
        h (..., A, A), linear.
    power_w
        p (..., A), W.
    sensitivity_w
        γ, W.

    Returns
    -------
    array of bool
        (..., A, A); False on the diagonal.
    """
    weaker_w = np.minimum(power_w[..., :, None], power_w[..., None, :])
    linked = weaker_w * gain >= sensitivity_w
    linked[..., np.arange(linked.shape[-1]), np.arange(linked.shape[-1])] = False
    return linked


def degrees(adjacency: Flags) -> Ints:
    """Number of neighbours k_a,n (eq. ka).

    Parameters
    ----------
    adjacency
        (..., A, A) without self links.

    Returns
    -------
    array of int
        (..., A).
    """
    return adjacency.sum(axis=-1)


def noise_w(radio: Radio) -> float:
    """Noise power in the whole band, σ²B.

    Parameters
    ----------
    radio
        In whose reading of `noise_dbm`.

    Returns
    -------
    float
        W.
    """
    power = float(dbm_to_w(radio.noise_dbm))
    return power if radio.noise_reading == "total" else power * radio.bandwidth_hz


def rate_bps(radio: Radio, power_w: Array, gain: Array) -> Array:
    """Capacity R = B log2(1 + p h / σ²B) (eq. Rab); arguments broadcast.

    Parameters
    ----------
    radio
        Band and noise.
    power_w
        p, W.
    gain
        h, linear.

    Returns
    -------
    array of float
        bit/s.
    """
    return radio.bandwidth_hz * np.log1p(power_w * gain / noise_w(radio)) / np.log(2.0)
