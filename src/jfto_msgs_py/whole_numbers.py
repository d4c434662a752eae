"""Whole numbers that callers give: Python's and numpy's integers, never truth values or floats."""

from __future__ import annotations

from numbers import Integral
from typing import Any

from jfto_msgs_py.errors import InputError

# As the scenario's `search.seed` has it.
GREATEST_SEED = 2**31 - 1


def whole_number(name: str, value: Any) -> int:
    """`value` as an int; InputError that names it where it is none, truth values included."""
    if isinstance(value, bool) or not isinstance(value, Integral):
        raise InputError(f"{name} is {value!r}, must be a whole number.")
    return int(value)


def checked_seed(seed: Any) -> int:
    """A search's seed as an int; InputError unless it is whole and 0 to 2147483647."""
    number = whole_number("seed", seed)
    if not 0 <= number <= GREATEST_SEED:
        raise InputError(f"seed is {number}, must be from 0 to {GREATEST_SEED}.")
    return number
