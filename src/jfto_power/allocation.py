"""Transmit powers that maximise the throughput of a given topology (P4)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from jfto_msgs_py.errors import InputError
from jfto_msgs_py.radio import Radio
from jfto_msgs_py.types import Array, Flags
from jfto_power.shortage import affordable_slots, check_energy
from jfto_power.water_level import fill_rows
from jfto_world.radio import noise_w


@dataclass(frozen=True)
class Allocation:
    """Best powers of N + 1 slots.

    `power_w` is (N + 1, A), `energy_j` (A,) what slots 1..N cost, `multiplier` (A,) the throughput
    in bit/s, summed over slots and ordered pairs, that one more joule would add (0 where the budget
    does not bind). `slots_held` is N, or less for an allocation over a prefix.
    """

    power_w: Array
    multiplier: Array
    energy_j: Array
    slots_held: int


def allocate(
    adjacency: Flags,
    gain: Array,
    p_low_w: Array,
    p_high_w: Array,
    energy_j: ArrayLike,
    slot_duration_s: float,
    radio: Radio,
    names: tuple[str, ...] = (),
) -> Allocation:
    """Maximise Σ_{n=1..N} Σ_{ordered linked pairs} B log2(1 + p_an h_abn / σ²B) exactly.

    `adjacency` and `gain` are (N + 1, A, B): A UAVs that decide and B that may listen, the whole
    fleet or, aboard one UAV, its own row (A = 1). Powers stay in [p_low_w, p_high_w], both
    (N + 1, A), and Σ_{n=1..N} p Δt ≤ `energy_j` (A,). Slot 0 costs nothing and follows the same
    water level. `names` label UAVs in messages. Raises InputError for arguments that contradict
    each other, EnergyShortage where the floor exceeds a budget.
    """
    adjacency, gain, low, high, energy = _checked(
        adjacency, gain, p_low_w, p_high_w, energy_j, slot_duration_s
    )
    check_energy(low, energy, slot_duration_s, names or default_names(energy.size))
    power, level = fill_rows(adjacency, gain, noise_w(radio), low, high, energy / slot_duration_s)
    per_joule = radio.bandwidth_hz / np.log(2.0) / slot_duration_s
    return Allocation(
        power_w=power,
        multiplier=per_joule / level,
        energy_j=power[1:].sum(axis=0) * slot_duration_s,
        slots_held=low.shape[0] - 1,
    )


def allocate_prefix(
    adjacency: Flags,
    gain: Array,
    p_low_w: Array,
    p_high_w: Array,
    energy_j: ArrayLike,
    slot_duration_s: float,
    radio: Radio,
) -> Allocation:
    """Best allocation over the longest run of slots from 0 that every UAV can afford.

    Arguments as for `allocate`; after the last slot held all powers are 0. This is what is left to
    do when `allocate` raises EnergyShortage.
    """
    adjacency, gain, low, high, energy = _checked(
        adjacency, gain, p_low_w, p_high_w, energy_j, slot_duration_s
    )
    held = int(affordable_slots(low, energy, slot_duration_s).min(initial=low.shape[0] - 1))
    stop = held + 1
    best = allocate(
        adjacency[:stop], gain[:stop], low[:stop], high[:stop], energy, slot_duration_s, radio
    )
    power = np.zeros_like(low)
    power[:stop] = best.power_w
    return Allocation(power, best.multiplier, best.energy_j, held)


def default_names(uav_count: int) -> tuple[str, ...]:
    """Names for UAVs that the caller did not name: uav1, uav2, ..."""
    return tuple(f"uav{index + 1}" for index in range(uav_count))


def _checked(
    adjacency: Flags,
    gain: Array,
    p_low_w: Array,
    p_high_w: Array,
    energy_j: ArrayLike,
    slot_duration_s: float,
) -> tuple[Flags, Array, Array, Array, Array]:
    adjacency = np.ascontiguousarray(adjacency, dtype=np.bool_)
    gain = np.ascontiguousarray(gain, dtype=np.float64)
    low = np.ascontiguousarray(p_low_w, dtype=np.float64)
    high = np.ascontiguousarray(p_high_w, dtype=np.float64)
    energy = np.ascontiguousarray(energy_j, dtype=np.float64)
    if adjacency.ndim != 3 or gain.shape != adjacency.shape:
        raise InputError(
            f"adjacency has shape {adjacency.shape} and gain {gain.shape}; both must be "
            "(slots, UAVs, listeners)."
        )
    if low.shape != adjacency.shape[:2] or high.shape != low.shape or not low.shape[0]:
        raise InputError(
            f"p_low_w has shape {low.shape} and p_high_w {high.shape}, "
            f"must be {adjacency.shape[:2]} with at least slot 0."
        )
    if energy.shape != (low.shape[1],):
        raise InputError(f"energy_j has shape {energy.shape}, must be ({low.shape[1]},).")
    if not slot_duration_s > 0:
        raise InputError(f"slot_duration_s is {slot_duration_s}, must be positive.")
    # Negated, so that NaN fails too.
    if not ((energy >= 0) & np.isfinite(energy)).all():
        raise InputError(f"energy_j is {energy.tolist()}, must be joules from 0.")
    wrong = np.argwhere(~((low >= 0) & (low <= high) & np.isfinite(high)))
    if wrong.size:
        slot, uav = wrong[0]
        raise InputError(
            f"power interval of UAV {uav} in slot {slot} is [{low[slot, uav]}, {high[slot, uav]}] "
            "W, must be ordered, finite and not negative."
        )
    if not (np.isfinite(gain) | ~adjacency).all() or (gain < 0).any():
        raise InputError("gain holds values that are negative or not finite on a link.")
    return adjacency, gain, low, high, energy
