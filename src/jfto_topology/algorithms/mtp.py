"""Maximum transmit power: the baseline that asks for every link there is."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from jfto_msgs_py.types import Array
from jfto_topology.algorithms.powered import PoweredTopology, played_out
from jfto_topology.algorithms.required_power import checked_caps, required_powers
from jfto_world.radio import Channel


def mtp(
    positions_m: Array,
    channel: Channel,
    p_max_w: Array,
    sensitivity_w: float,
    energy_j: ArrayLike,
    slot_duration_s: float,
) -> PoweredTopology:
    """Every UAV at P_a,max until its energy is gone, then off the air.

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
    caps_w = checked_caps(p_max_w, required_w.shape[1])
    wanted_w = np.broadcast_to(caps_w, required_w.shape[:2]).copy()
    return played_out(required_w, wanted_w, np.isfinite(required_w), energy_j, slot_duration_s)
