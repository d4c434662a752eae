"""The energy account of a mission on disk, so that a restart gives nothing back."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from jfto_msgs_py.errors import InputError
from jfto_msgs_py.read_text import read_text
from jfto_msgs_py.write_file import write_file

ENERGY_FORMAT = "jfto-energy"
ENERGY_VERSION = 2
_SIZE_LIMIT = 1_000_000


@dataclass(frozen=True)
class EnergyState:
    """Energy left (J) and power in force (W) of each UAV at `at_ns`, out of `budget_j`.

    `charged_from_ns` is since when powers were charged, None where the mission had not begun.
    """

    at_ns: int
    charged_from_ns: int | None
    budget_j: dict[str, float]
    left_j: dict[str, float]
    power_w: dict[str, float]


def write_energy(state: EnergyState, path: Path) -> None:
    """Write the account; raises InputError where that cannot be done."""
    document = {"format": ENERGY_FORMAT, "version": ENERGY_VERSION, **vars(state)}
    write_file(path, json.dumps(document, indent=1) + "\n")


def read_energy(path: Path, budget_j: dict[str, float]) -> EnergyState:
    """The account in a file; raises InputError where it is none, or of another fleet."""
    text = read_text(path, InputError, "energy account", _SIZE_LIMIT)
    try:
        document = json.loads(text)
        state = _state_of(document)
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        raise InputError(
            f"{path}: is no energy account ({error!r}). Name another file, or delete it to start "
            "with full budgets."
        ) from None
    if state.budget_j != budget_j:
        raise InputError(
            f"{path}: was kept for other budgets or another fleet. Name another file, or delete "
            "it to start with full budgets."
        )
    return state


def _state_of(document: Any) -> EnergyState:
    if (document["format"], document["version"]) != (ENERGY_FORMAT, ENERGY_VERSION):
        raise ValueError("other format or version")
    tables = []
    for name in ("budget_j", "left_j", "power_w"):
        table = {str(uav): float(value) for uav, value in document[name].items()}
        if not all(math.isfinite(value) and value >= 0 for value in table.values()):
            raise ValueError(f"{name} holds a value below 0 or not finite")
        tables.append(table)
    if not tables[0].keys() == tables[1].keys() == tables[2].keys():
        raise ValueError("the tables name different UAVs")
    begun_ns = document["charged_from_ns"]
    return EnergyState(int(document["at_ns"]), None if begun_ns is None else int(begun_ns), *tables)
