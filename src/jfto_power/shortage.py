"""Too little energy for the powers that the topology asks for."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from jfto_msgs_py.errors import InfeasibleError
from jfto_msgs_py.types import Array

# A floor that equals the budget on paper may exceed it in the last bits.
ROUNDING = 1e-12


class EnergyShortage(InfeasibleError):  # noqa: N818 - a state of the fleet, not a fault
    """Some UAVs cannot afford the least powers of their topology.

    `uavs` are their indices, `missing_j` (K,) what each lacks, `held_slots` (K,) the number of
    slots n = 1, 2, ... that each can hold, and `prefix_slots` the number that the whole fleet can.
    """

    def __init__(
        self,
        uavs: tuple[int, ...],
        names: tuple[str, ...],
        missing_j: Array,
        held_slots: NDArray[np.int64],
    ) -> None:
        self.uavs = uavs
        self.missing_j = missing_j
        self.held_slots = held_slots
        self.prefix_slots = int(held_slots.min())
        each = "; ".join(
            f"{name} lacks {missing:.3g} J and holds {held} slots"
            for name, missing, held in zip(names, missing_j, held_slots, strict=True)
        )
        super().__init__(
            f"Energy budget below the least that the topology costs: {each}. "
            f"The fleet as a whole holds {_slots(self.prefix_slots)}.",
            cures=(
                f"{missing_j.max():.3g} J more energy",
                "higher antenna gain",
                "a smaller k_min",
                "routes that stay closer together",
            ),
        )


def _slots(count: int) -> str:
    return f"slots 1 to {count}" if count > 1 else ("slot 1" if count else "no slot")


def affordable_slots(p_low_w: Array, energy_j: Array, slot_duration_s: float) -> NDArray[np.int64]:
    """Number of slots n = 1, 2, ... whose least powers each UAV can pay for, (A,).

    `p_low_w` is (N + 1, A), slot 0 being free.
    """
    spent_j = np.cumsum(p_low_w[1:], axis=0) * slot_duration_s
    return (spent_j <= energy_j * (1 + ROUNDING)).sum(axis=0, dtype=np.int64)


def check_energy(
    p_low_w: Array, energy_j: Array, slot_duration_s: float, names: tuple[str, ...]
) -> None:
    """Raise EnergyShortage unless each UAV can pay for its least powers in all slots."""
    floor_j = p_low_w[1:].sum(axis=0) * slot_duration_s
    short = np.flatnonzero(floor_j > energy_j * (1 + ROUNDING))
    if short.size:
        held = affordable_slots(p_low_w, energy_j, slot_duration_s)
        raise EnergyShortage(
            tuple(int(a) for a in short),
            tuple(names[a] for a in short),
            (floor_j - energy_j)[short],
            held[short],
        )
