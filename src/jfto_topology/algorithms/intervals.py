"""Transmit-power intervals that keep a given set of links, down to what powers can tell apart."""

from __future__ import annotations

import numpy as np

from jfto_msgs_py.types import Array, Flags
from jfto_topology.algorithms.required_power import checked_caps, required_powers
from jfto_world.radio import Channel

# Powers closer than this, relatively, belong to one ring: an interval between them would be too
# narrow for any radio, and rounding alone separates UAVs that hover on a regular grid.
RING_WIDTH = 1e-9


def ring_powers(required_w: Array) -> Array:
    """Power that takes in b together with all that a cannot tell apart from b by power.

    `required_w` is (M, A, A); so is the result: the greatest entry of the run of entries of a's
    row around b whose neighbours lie within RING_WIDTH of each other. Not symmetric.
    """
    order = np.argsort(required_w, axis=-1, kind="stable")
    rising = np.take_along_axis(required_w, order, axis=-1)
    joined = rising[..., 1:] <= rising[..., :-1] * (1.0 + RING_WIDTH)
    for rank in range(required_w.shape[-1] - 2, -1, -1):
        here, beyond = rising[..., rank], rising[..., rank + 1]
        rising[..., rank] = np.where(joined[..., rank], beyond, here)
    ring_w = np.empty_like(required_w)
    np.put_along_axis(ring_w, order, rising, axis=-1)
    return ring_w


def power_intervals(
    required_w: Array, ring_w: Array, active: Flags, p_max_w: Array
) -> tuple[Array, Array, Array, Flags]:
    """P̃min, P̃max, the greatest safe power, and the mutual reach they make.

    `required_w`, `ring_w` and `active` are (M, A, A), `p_max_w` (A,). P̃min serves the farthest
    active neighbour (0 without one); P̃max is the power of the next candidate beyond, exclusive,
    or P_a,max, inclusive, where there is none (eq. Pmax1). The third result is always inclusive.
    Every choice of powers inside the intervals makes the same mutual reach (M, A, A).
    """
    low = np.where(active, ring_w, 0.0).max(axis=2, initial=0.0)
    beyond = np.where(required_w > low[..., None], required_w, np.inf)
    following = beyond.min(axis=2, initial=np.inf)
    bound = np.minimum(following, p_max_w)
    # Rings are RING_WIDTH apart, so half of it stays clear of both sides.
    upper = np.minimum(following * (1.0 - RING_WIDTH / 2), p_max_w)
    reach = required_w <= np.minimum(low[:, :, None], low[:, None, :])
    return low, bound, upper, reach


def kept_intervals(
    adjacency: Flags, positions_m: Array, channel: Channel, p_max_w: Array, sensitivity_w: float
) -> tuple[Array, Array]:
    """Least and greatest safe powers (M, A) that keep the links of `adjacency` (M, A, A).

    As C-TOP does for its own links, so that a baseline's topology can be given the exact power
    allocation too. Links that are out of reach at P_a,max are left out.
    """
    required_w = required_powers(positions_m, channel, p_max_w, sensitivity_w)
    active = np.ascontiguousarray(adjacency & np.isfinite(required_w))
    caps_w = checked_caps(p_max_w, required_w.shape[1])
    low, _, upper, _ = power_intervals(required_w, ring_powers(required_w), active, caps_w)
    return low, upper
