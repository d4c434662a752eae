"""The energy book of a running mission, kept in a file where one is named."""

from __future__ import annotations

from pathlib import Path

from jfto_power.energy_file import EnergyState, read_energy, write_energy
from jfto_power.horizon import EnergyBook


class EnergyAccount:
    """Energy left and powers in force; goes on from `file` where that exists.

    While nobody kept the book, the powers last in force went on drawing. `now_ns` is the clock's
    time, 0 if it has not begun. Raises InputError for a file that cannot be used.
    """

    def __init__(self, budget_j: dict[str, float], file: Path | None, now_ns: int) -> None:
        self.budget_j = dict(budget_j)
        self.power_w = dict.fromkeys(budget_j, 0.0)
        self._file = file
        if file is None or not file.exists():
            self._book = EnergyBook(budget_j)
            return
        state = read_energy(file, self.budget_j)
        self._book = EnergyBook(state.left_j)
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

    def save(self, now_ns: int) -> None:
        """Write the file, if one is named; raises InputError where it cannot be written."""
        if self._file is not None:
            self.advance(now_ns)
            state = EnergyState(now_ns, self.budget_j, dict(self.left_j), dict(self.power_w))
            write_energy(state, self._file)
