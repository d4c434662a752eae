"""Who hears whom."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from jfto_msgs_py.types import Array


def pairwise_distances(positions_m: Array) -> Array:
    """Distances between all UAVs at every instant.

    `positions_m` has shape (..., A, 3); the result has shape (..., A, A).
    """
    difference = positions_m[..., :, None, :] - positions_m[..., None, :, :]
    return np.sqrt(np.einsum("...k,...k->...", difference, difference))


def mutual_links(gain: Array, power_w: Array, sensitivity_w: float) -> NDArray[np.bool_]:
    """Adjacency: a and b are linked iff min(p_a, p_b) h_ab ≥ γ (eq. cab, made symmetric).

    `gain` has shape (..., A, A) and `power_w` (..., A); the diagonal of the result is False.
    """
    weaker_w = np.minimum(power_w[..., :, None], power_w[..., None, :])
    linked = weaker_w * gain >= sensitivity_w
    linked[..., np.arange(linked.shape[-1]), np.arange(linked.shape[-1])] = False
    return linked


def degrees(adjacency: NDArray[np.bool_]) -> NDArray[np.int64]:
    """Number of neighbours k_a,n (eq. ka); shape (..., A) from (..., A, A) without self links."""
    return adjacency.sum(axis=-1)
