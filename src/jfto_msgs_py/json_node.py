"""A strict walk through parsed JSON that can say where it stands."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from jfto_msgs_py.errors import PlanError
from jfto_msgs_py.scenario.suggest import nearest

_NAMES = {dict: "an object", list: "a list", str: "text", bool: "true or false", type(None): "null"}


@dataclass(frozen=True)
class JsonNode:
    """A value inside a JSON file and the dotted name of its place; all errors are PlanError."""

    value: Any
    file: str
    where: str = ""

    def error(self, reason: str) -> PlanError:
        """Error that names the file and this place."""
        return PlanError(f"{self.file}: {self.where or 'the file'} {reason}")

    def keys(self, required: Iterable[str], optional: Iterable[str] = ()) -> dict[str, JsonNode]:
        """Members of an object that has all of `required` and nothing unknown."""
        self._need(dict, "an object")
        known = [*required, *optional]
        for name in self.value:
            if name not in known:
                guess = nearest(name, known)
                cure = f"Did you mean {guess}?" if guess else f"Known are {', '.join(known)}."
                raise self.error(f"has an unknown key {name}. {cure}")
        for name in required:
            if name not in self.value:
                raise self.error(f"lacks {name}. Write the plan anew with jfto plan.")
        prefix = f"{self.where}." if self.where else ""
        return {
            name: JsonNode(value, self.file, f"{prefix}{name}")
            for name, value in self.value.items()
        }

    def items(self) -> list[JsonNode]:
        """Entries of a list."""
        self._need(list, "a list")
        return [
            JsonNode(value, self.file, f"{self.where}[{index}]")
            for index, value in enumerate(self.value)
        ]

    def text(self) -> str:
        """Text, not empty."""
        self._need(str, "text")
        if not self.value:
            raise self.error("is empty. Give it a value.")
        return str(self.value)

    def flag(self) -> bool:
        """True or false."""
        self._need(bool, "true or false")
        return bool(self.value)

    def integer(self, low: int) -> int:
        """Whole number of at least `low`."""
        if isinstance(self.value, bool) or not isinstance(self.value, int):
            raise self.error(f"is {self._shown()}, must be a whole number of at least {low}.")
        if self.value < low:
            raise self.error(f"is {self.value}, must be at least {low}.")
        return self.value

    def number(self, low: float = -math.inf, high: float = math.inf) -> float:
        """Finite number between `low` and `high`."""
        if isinstance(self.value, bool) or not isinstance(self.value, int | float):
            raise self.error(f"is {self._shown()}, must be a number.")
        if abs(self.value) > 1e300:
            raise self.error(f"is {self._shown()}, must be finite.")
        if not low <= self.value <= high:
            raise self.error(f"is {self.value:g}, must be {_between(low, high)}.")
        return float(self.value)

    def number_or_none(self) -> float | None:
        """Finite number, or None for null."""
        return None if self.value is None else self.number()

    def vector(self) -> tuple[float, float, float]:
        """Three finite numbers."""
        entries = self.items()
        if len(entries) != 3:
            raise self.error(f"has {len(entries)} numbers, needs 3: east, north, up in metres.")
        return entries[0].number(), entries[1].number(), entries[2].number()

    def array(self, shape: tuple[int, ...]) -> NDArray[np.float64]:
        """Nested lists of finite numbers as an array of exactly the given shape."""
        self._need_shape(shape)
        array = np.array(self.value, dtype=np.float64).reshape(shape)
        if not np.isfinite(array).all():
            raise self.error("holds a number that is not finite. Write the plan anew.")
        return array

    def _need_shape(self, shape: tuple[int, ...]) -> None:
        if not shape:
            self.number()
            return
        entries = self.items()
        if len(entries) != shape[0]:
            raise self.error(f"has {len(entries)} entries, needs {shape[0]}.")
        for entry in entries:
            entry._need_shape(shape[1:])

    def _need(self, kind: type, wanted: str) -> None:
        if not isinstance(self.value, kind):
            raise self.error(f"is {self._shown()}, must be {wanted}.")

    def _shown(self) -> str:
        return _NAMES.get(type(self.value), f"{self.value!r:.40}")


def parse_json(text: str, path: Path) -> JsonNode:
    """Parse a JSON text without NaN, infinities or doubled keys; raises PlanError."""

    def unique(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
        seen = dict(pairs)
        if len(seen) != len(pairs):
            names = [name for name, _ in pairs]
            twice = next(name for name in names if names.count(name) > 1)
            raise PlanError(f"{path}: {twice} is given twice in one object. Remove one.")
        return seen

    def no_constant(name: str) -> None:
        raise PlanError(f"{path}: holds {name}, which JSON does not know. Write the plan anew.")

    try:
        value = json.loads(text, object_pairs_hook=unique, parse_constant=no_constant)
    except json.JSONDecodeError as error:
        raise PlanError(
            f"{path}:{error.lineno}: is not valid JSON: {error.msg} at column {error.colno}. "
            "Is the file complete? Write it anew with jfto plan."
        ) from None
    except RecursionError:
        raise PlanError(f"{path}: is nested too deep. Is it a plan file?") from None
    except ValueError as error:
        raise PlanError(f"{path}: is not valid JSON: {error}. Write the plan anew.") from None
    return JsonNode(value, str(path))


def _between(low: float, high: float) -> str:
    if math.isinf(high):
        return f"at least {low:g}"
    return f"{low:g}…{high:g}"
