"""What transmitting costs, and whether it lasts."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from jfto_msgs_py.types import Array


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
