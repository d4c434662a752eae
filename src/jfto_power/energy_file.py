"""The energy account of a mission on disk, so that a restart gives nothing back."""

from __future__ import annotations

from pathlib import Path

from jfto_msgs_py.files import FileKind, read_record, write_record
from jfto_power.energy_account import EnergyAccount, EnergyState

_FILE = FileKind(
    "energy account",
    "Name another file, or delete it to start with full budgets.",
    format="jfto-energy",
    version=2,
)


def open_account(budget_j: dict[str, float], file: Path | None, now_ns: int) -> EnergyAccount:
    """The account in a file, or a new one where no file is named or there is none yet.

    `now_ns` is the clock's time, 0 if it has not begun. Raises InputError where the file is no
    account, or one of other budgets or another fleet.
    """
    if file is None or not file.exists():
        return EnergyAccount(budget_j)
    state = read_record(file, EnergyState, _FILE)
    if state.budget_j != budget_j:
        raise _FILE.fault(f"{file}: was kept for other budgets or another fleet.")
    return EnergyAccount.resumed(state, now_ns)


def write_account(state: EnergyState, file: Path) -> None:
    """Write an account; raises InputError where that cannot be done."""
    write_record(state, file, _FILE)
