"""What a field of a record may hold, beyond its type: notes in `Annotated` that readers keep to."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

# For `Annotated`: text that is not empty; a number that is null where it is not known.
FILLED = "filled"
NULL_IS_NAN = "null is NaN"
# For `dataclasses.field`: what a file may leave out.
MAY_LACK: Mapping[str, Any] = MappingProxyType({"may_lack": True})


@dataclass(frozen=True)
class Range:
    """For `Annotated`: numbers from `low` to `high`, `low` itself left out where `above`."""

    low: float = -math.inf
    high: float = math.inf
    above: bool = False

    def problem(self, value: float) -> str:
        """What is wrong with a number, "" if nothing is."""
        if self.low <= value <= self.high and not (self.above and value == self.low):
            return ""
        if self.above and self.low == 0:
            return "must be positive"
        if math.isinf(self.high):
            return f"must be at least {self.low:g}"
        return f"must be {self.low:g}…{self.high:g}"


@dataclass(frozen=True)
class OneOf:
    """For `Annotated`: the words that a text may be."""

    words: tuple[str, ...]
