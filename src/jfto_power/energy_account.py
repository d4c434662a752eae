"""The energy book of a running mission, kept in a file where one is named."""

from __future__ import annotations

from pathlib import Path

from jfto_power.energy_file import EnergyState, read_energy, write_energy
from jfto_power.horizon import EnergyBook

# Below that share of its budget a UAV has none left: times are whole nanoseconds.
_NOTHING = 1e-7


class EnergyAccount:
    """Energy left and powers in force; goes on from `file` where that exists.

    Powers are charged from the mission's time zero on, once that is known. While nobody kept the
    book, the powers last in force went on drawing. `now_ns` is the clock's time, 0 if it has not
    begun. Raises InputError for a file that cannot be used.
    """

    def __init__(self, budget_j: dict[str, float], file: Path | None, now_ns: int) -> None:
        self.budget_j = dict(budget_j)
        self.power_w = dict.fromkeys(budget_j, 0.0)
        self._file = file
        if file is None or not file.exists():
            self._book = EnergyBook(budget_j, None)
            return
        state = read_energy(file, self.budget_j)
        self._book = EnergyBook(state.left_j, state.charged_from_ns)
        self._book.charged_from_ns = state.charged_from_ns
        self.power_w = dict(state.power_w)
        # A clock that is behind the file was set back: nothing is drawn until it goes on.
        since_ns = min(state.at_ns, now_ns) if now_ns else state.at_ns
        self._book.set_powers(since_ns, self.power_w)

    @property
    def left_j(self) -> dict[str, float]:
        """Energy left to each UAV, J, as of the last `advance`."""
        return self._book.left_j

    def advance(self, now_ns: int) -> None:
        """Charge the powers in force until now."""
        self._book.advance(now_ns)

    def set_powers(self, now_ns: int, power_w: dict[str, float]) -> set[str]:
        """Put powers in force; returns the UAVs whose power has changed."""
        changed = {uav for uav, power in power_w.items() if self.power_w[uav] != power}
        self._book.set_powers(now_ns, power_w)
        self.power_w.update(power_w)
        return changed

    def set_zero(self, zero_ns: int) -> None:
        """Say when the mission begins, or began."""
        self._book.set_zero(zero_ns)

    def empty_ns(self) -> int | None:
        """When the first UAV has used up its energy at the powers in force; None: never."""
        return self._book.empty_ns()

    def used_up(self, uav_id: str) -> bool:
        """Whether a UAV has no energy left, but for rounding."""
        return self.left_j[uav_id] <= _NOTHING * self.budget_j[uav_id]

    def save(self, now_ns: int) -> None:
        """Write the file, if one is named; raises InputError where it cannot be written."""
        if self._file is not None:
            self.advance(now_ns)
            state = EnergyState(
                now_ns,
                self._book.charged_from_ns,
                self.budget_j,
                dict(self.left_j),
                dict(self.power_w),
            )
            write_energy(state, self._file)
