"""Loss behind a ridge."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from jfto_msgs_py.types import Array
from jfto_msgs_py.units import SPEED_OF_LIGHT_MPS

# Height of the ground in metres of the ENU frame at metres east and north, arrays of one shape.
Ground = Callable[[Array, Array], Array]

# Points looked at along a link, its ends left out.
_PROFILE_POINTS = 64
# Below this ν a knife edge takes nothing away.
_CLEAR_V = -0.78


def knife_edge_loss_db(v: Array) -> Array:
    """J(ν), loss behind a knife edge in dB, 0 where ν ≤ -0.78. Source: ITU-R P.526, eq. 31."""
    shifted = np.maximum(v, _CLEAR_V) - 0.1
    loss = 6.9 + 20 * np.log10(np.sqrt(shifted**2 + 1) + shifted)
    return np.where(v > _CLEAR_V, np.maximum(loss, 0.0), 0.0)


def terrain_loss_db(positions_m: Array, ground: Ground, frequency_hz: float) -> Array:
    """Loss of every pair by its worst single edge in dB, (A, A), symmetric, 0 on the diagonal.

    `positions_m` is (A, 3) in the frame that `ground` is in. One edge only: a lower bound behind
    several ridges.
    """
    count = len(positions_m)
    first, second = np.triu_indices(count, 1)
    share = np.linspace(0, 1, _PROFILE_POINTS + 2)[1:-1]
    a, b = positions_m[first], positions_m[second]
    points = a[:, None, :] + share[None, :, None] * (b - a)[:, None, :]
    above = ground(points[..., 0], points[..., 1]) - points[..., 2]
    length = np.maximum(np.linalg.norm(b - a, axis=1), 1.0)[:, None]
    wavelength_m = SPEED_OF_LIGHT_MPS / frequency_hz
    v = above * np.sqrt(2 / (wavelength_m * length * share * (1 - share)))
    loss = np.zeros((count, count))
    loss[first, second] = loss[second, first] = knife_edge_loss_db(v.max(axis=1, initial=-np.inf))
    return loss
