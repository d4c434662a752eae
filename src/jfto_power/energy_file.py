"""The energy account of a mission on disk, so that a restart gives nothing back."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from jfto_msgs_py.errors import InputError
from jfto_msgs_py.files import FileKind, read_record, write_record
from jfto_msgs_py.records.fields import Range

_FILE = FileKind(
    "energy account",
    "Name another file, or delete it to start with full budgets.",
    format="jfto-energy",
    version=2,
)
NotNegative = Annotated[float, Range(0.0)]


@dataclass(frozen=True)
class EnergyState:
    """Energy left (J) and power in force (W) of each UAV at `at_ns`, out of `budget_j`.

    `charged_from_ns` is since when powers were charged, None where the mission had not begun.
    Raises InputError where the tables do not name the same UAVs.
    """

    at_ns: int
    charged_from_ns: int | None
    budget_j: dict[str, NotNegative]
    left_j: dict[str, NotNegative]
    power_w: dict[str, NotNegative]

    def __post_init__(self) -> None:
        if not self.budget_j.keys() == self.left_j.keys() == self.power_w.keys():
            raise InputError("budget_j, left_j and power_w name different UAVs.")


def write_energy(state: EnergyState, path: Path) -> None:
    """Write the account; raises InputError where that cannot be done."""
    write_record(state, path, _FILE)


def read_energy(path: Path, budget_j: dict[str, float]) -> EnergyState:
    """The account in a file; raises InputError where it is none, or of another fleet."""
    state = read_record(path, EnergyState, _FILE)
    if state.budget_j != budget_j:
        raise _FILE.fault(f"{path}: was kept for other budgets or another fleet.")
    return state
