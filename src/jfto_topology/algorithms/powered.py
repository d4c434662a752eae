"""What a topology-control algorithm without power intervals leaves behind."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from jfto_msgs_py.errors import InputError
from jfto_msgs_py.types import Array, Flags

# A budget that fits on paper may miss by the last bits.
ROUNDING = 1e-12


@dataclass(frozen=True)
class PoweredTopology:
    """Transmit powers of M slots and the links that they make.

    `power_w` is (M, A), and `on_air` (M, A) is False once a UAV's energy is gone. `adjacency`
    (M, A, A) holds every pair that hears each other at these powers; `listed` (M, A, A) the links
    among them that the algorithm itself asked for. Nothing is on the diagonals.
    """

    adjacency: Flags
    power_w: Array
    listed: Flags
    on_air: Flags


def played_out(
    required_w: Array,
    wanted_w: Array,
    listed: Flags,
    energy_j: ArrayLike,
    slot_duration_s: float,
) -> PoweredTopology:
    """Topology that wanted powers make when energy runs out as it will.

    `required_w` is (M, A, A) as from `required_powers`, `wanted_w` (M, A). Slot 0 is free. A UAV
    goes off the air at the first slot that it cannot pay for in full and stays off. Raises
    InputError for a budget or slot that makes no sense.
    """
    energy = np.asarray(energy_j, dtype=np.float64)
    if energy.ndim == 0:
        energy = np.full(wanted_w.shape[1], energy)
    if energy.shape != wanted_w.shape[1:] or not (energy >= 0).all():
        raise InputError(f"energy_j is {energy.tolist()}, must be joules from 0, one per UAV.")
    if not slot_duration_s > 0:
        raise InputError(f"slot_duration_s is {slot_duration_s}, must be positive.")
    spent_j = np.cumsum(wanted_w, axis=0) * slot_duration_s - wanted_w[0] * slot_duration_s
    on_air = spent_j <= energy * (1 + ROUNDING)
    power_w = np.where(on_air, wanted_w, 0.0)
    weaker_w = np.minimum(power_w[:, :, None], power_w[:, None, :])
    adjacency = required_w <= weaker_w
    return PoweredTopology(adjacency, power_w, listed & adjacency, on_air)
