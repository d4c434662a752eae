"""The vehicle's parameters: ArduCopter 4.5.5's full list with its defaults, typed storage, changes.

Values travel as 32-bit floats whatever the type, as ArduPilot sends them.
"""

from __future__ import annotations

import csv
import struct
from dataclasses import dataclass
from functools import cache
from importlib.resources import files

from jfto_msgs_py.errors import InputError

INT8, INT16, INT32, REAL32 = 2, 4, 6, 9
_RANGE = {INT8: 8, INT16: 16, INT32: 32}
_READ_ONLY = ("MIS_TOTAL", "FENCE_TOTAL", "RALLY_TOTAL", "FORMAT_VERSION", "STAT_RUNTIME")


@dataclass(frozen=True)
class Definition:
    """Name, default and MAV_PARAM_TYPE of one parameter."""

    name: str
    default: float
    kind: int


@cache
def definitions() -> tuple[Definition, ...]:
    """All parameters in the order of their indices."""
    text = files("jfto_sim").joinpath("data/copter_4_5_5_parameters.csv").read_text()
    rows = csv.DictReader(text.splitlines())
    return tuple(Definition(r["name"], float(r["value"]), int(r["type"])) for r in rows)


@cache
def _index() -> dict[str, int]:
    return {d.name: k for k, d in enumerate(definitions())}


def as_float32(value: float) -> float:
    """The value as a 32-bit float holds it."""
    return float(struct.unpack("<f", struct.pack("<f", value))[0])


class Parameters:
    """Parameter values of one vehicle; they outlive a restart."""

    def __init__(self, overrides: dict[str, float]) -> None:
        self._values: dict[str, float] = {}
        for name, value in overrides.items():
            if name not in _index():
                raise InputError(f"{name} is not a parameter of ArduCopter 4.5.5.")
            self.store(name, value)

    @property
    def count(self) -> int:
        """How many parameters there are."""
        return len(definitions())

    def __contains__(self, name: str) -> bool:
        return name in _index()

    def __getitem__(self, name: str) -> float:
        value = self._values.get(name)
        return definitions()[_index()[name]].default if value is None else value

    def kind(self, name: str) -> int:
        """MAV_PARAM_TYPE of a parameter."""
        return definitions()[_index()[name]].kind

    def read_only(self, name: str) -> bool:
        """Whether a station may not write it."""
        return name in _READ_ONLY

    def name_at(self, index: int) -> str | None:
        """Name at an index of the list, None outside it."""
        table = definitions()
        return table[index].name if 0 <= index < len(table) else None

    def store(self, name: str, value: float) -> float:
        """Keep a value as the parameter's type can hold it, without any range check."""
        kind = self.kind(name)
        if kind == REAL32:
            kept = as_float32(value)
        else:
            bits = _RANGE[kind]
            whole = int(max(-(2.0**31), min(2.0**31 - 1, value)))
            half = 1 << (bits - 1)
            kept = float(max(-half, min(half - 1, whole)))
        self._values[name] = kept
        return kept
