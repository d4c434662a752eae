"""Transmit powers that maximise the throughput of a given topology (P4)."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from jfto_msgs_py.errors import InputError
from jfto_msgs_py.records.radio import Radio
from jfto_msgs_py.types import Array, Flags
from jfto_power.shortage import affordable_slots, check_energy
from jfto_power.water_level import fill_rows
from jfto_world.radio import noise_w


@dataclass(frozen=True, eq=False)
class PowerProblem:
    """One instance of (P4): who is linked, what links gain, and what may be sent.

    `adjacency` and `gain` are (N + 1, A, B): A UAVs that decide and B that may listen, the whole
    fleet or, aboard one UAV, its own row (A = 1). Powers stay in [`p_low_w`, `p_high_w`], both
    (N + 1, A), and Σ_{n=1..N} p Δt ≤ `energy_j` (A,), Δt being `slot_duration_s`; `radio` has
    bandwidth and noise. `names` label UAVs in messages: uav1, uav2, … where there are none.
    Anything that numpy reads as such arrays will do. Raises InputError for values that contradict
    each other.
    """

    adjacency: Flags
    gain: Array
    p_low_w: Array
    p_high_w: Array
    energy_j: Array
    slot_duration_s: float
    radio: Radio
    names: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        self._set("adjacency", np.ascontiguousarray(self.adjacency, dtype=np.bool_))
        for name in ("gain", "p_low_w", "p_high_w", "energy_j"):
            self._set(name, np.ascontiguousarray(getattr(self, name), dtype=np.float64))
        self._check_shapes()
        self._check_values()
        self._set(
            "names", tuple(self.names) or tuple(f"uav{a + 1}" for a in range(self.energy_j.size))
        )

    def prefix(self, stop: int) -> PowerProblem:
        """The same problem of slots 0 … `stop` - 1 alone."""
        arrays = {
            name: getattr(self, name)[:stop]
            for name in ("adjacency", "gain", "p_low_w", "p_high_w")
        }
        return replace(self, **arrays)

    def _set(self, name: str, value: object) -> None:
        object.__setattr__(self, name, value)

    def _check_shapes(self) -> None:
        linked, gain, low, high = self.adjacency, self.gain, self.p_low_w, self.p_high_w
        if linked.ndim != 3 or gain.shape != linked.shape:
            raise InputError(
                f"adjacency has shape {linked.shape} and gain {gain.shape}; both must be "
                "(slots, UAVs, listeners)."
            )
        if low.shape != linked.shape[:2] or high.shape != low.shape or not low.shape[0]:
            raise InputError(
                f"p_low_w has shape {low.shape} and p_high_w {high.shape}, "
                f"must be {linked.shape[:2]} with at least slot 0."
            )
        if self.energy_j.shape != (low.shape[1],):
            raise InputError(
                f"energy_j has shape {self.energy_j.shape}, must be ({low.shape[1]},)."
            )
        if self.names and len(self.names) != low.shape[1]:
            raise InputError(f"names has {len(self.names)} entries for {low.shape[1]} UAVs.")

    def _check_values(self) -> None:
        gain, low, high, energy = self.gain, self.p_low_w, self.p_high_w, self.energy_j
        if not isinstance(self.radio, Radio):
            raise InputError(
                f"radio is {self.radio!r}, must be a jfto_msgs_py.records.radio.Radio."
            )
        if not self.slot_duration_s > 0:
            raise InputError(f"slot_duration_s is {self.slot_duration_s}, must be positive.")
        # Negated, so that NaN fails too.
        if not ((energy >= 0) & np.isfinite(energy)).all():
            raise InputError(f"energy_j is {energy.tolist()}, must be joules from 0.")
        wrong = np.argwhere(~((low >= 0) & (low <= high) & np.isfinite(high)))
        if wrong.size:
            slot, uav = wrong[0]
            raise InputError(
                f"power interval of UAV {uav} in slot {slot} is [{low[slot, uav]}, "
                f"{high[slot, uav]}] W, must be ordered, finite and not negative."
            )
        if self.adjacency.shape[1] == self.adjacency.shape[2]:
            itself = np.argwhere(np.diagonal(self.adjacency, axis1=1, axis2=2))
            # One UAV with its own row alone may listen to another one.
            if itself.size and self.adjacency.shape[1] > 1:
                slot, uav = itself[0]
                raise InputError(
                    f"adjacency links UAV {uav} to itself in slot {slot}; clear the diagonal."
                )
        if not (np.isfinite(gain) | ~self.adjacency).all() or (gain < 0).any():
            raise InputError("gain holds values that are negative or not finite on a link.")


@dataclass(frozen=True, eq=False)
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


def allocate(problem: PowerProblem) -> Allocation:
    """Maximise Σ_{n=1..N} Σ_{ordered linked pairs} B log2(1 + p_an h_abn / σ²B) exactly.

    Slot 0 costs nothing and follows the same water level.

    Parameters
    ----------
    problem
        Links, gains, power intervals and budgets.

    Returns
    -------
    Allocation
        The best powers, and what one more joule would add.

    Raises
    ------
    EnergyShortage
        Where the least powers exceed a budget: names each UAV and what it lacks.
    """
    low, high, energy = problem.p_low_w, problem.p_high_w, problem.energy_j
    slot_s = problem.slot_duration_s
    check_energy(low, energy, slot_s, problem.names)
    noise = noise_w(problem.radio)
    power, level = fill_rows(problem.adjacency, problem.gain, noise, low, high, energy / slot_s)
    per_joule = problem.radio.bandwidth_hz / np.log(2.0) / slot_s
    return Allocation(
        power_w=power,
        multiplier=per_joule / level,
        energy_j=power[1:].sum(axis=0) * slot_s,
        slots_held=low.shape[0] - 1,
    )


def allocate_prefix(problem: PowerProblem) -> Allocation:
    """Best allocation over the longest run of slots from 0 that every UAV can afford.

    This is what is left to do when `allocate` raises EnergyShortage.

    Parameters
    ----------
    problem
        As for `allocate`.

    Returns
    -------
    Allocation
        After the last slot held, `slots_held`, all powers are 0.
    """
    low = problem.p_low_w
    affordable = affordable_slots(low, problem.energy_j, problem.slot_duration_s)
    held = int(affordable.min(initial=low.shape[0] - 1))
    best = allocate(problem.prefix(held + 1))
    power = np.zeros_like(low)
    power[: held + 1] = best.power_w
    return Allocation(power, best.multiplier, best.energy_j, held)
