"""What a field of a record may hold, beyond its type, and how a key of a scenario says so.

Readers of files keep to notes in `Annotated`; parameters are described to people too.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, TypeVar, get_args, get_origin, get_type_hints

Record = TypeVar("Record")

# For `Annotated`: text that is not empty; a number that is null where it is not known.
FILLED = "filled"
NULL_IS_NAN = "null is NaN"
# For `dataclasses.field`: what a file may leave out.
MAY_LACK: Mapping[str, Any] = MappingProxyType({"may_lack": True})
_KIND_OF_TYPE = {bool: "bool", int: "int", float: "float", str: "text"}


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


@dataclass(frozen=True)
class Key:
    """Description of one scenario key.

    `kind` is "bool", "int", "float" or "text"; `array` says that it holds a list, of `length`
    entries where that is fixed. A `per_uav` array has one entry per UAV, or one for all of them.
    `low` and `high` bound every entry, and are themselves allowed unless `strict`. `choices` lists
    the allowed texts. A key that is not `hashed` cannot change a result for a given seed. One
    that came `later` than plans whose hash must not change does not count at its default.
    """

    name: str
    kind: str
    array: bool
    default: Any
    doc: str
    unit: str = ""
    low: float | None = None
    high: float | None = None
    strict: bool = False
    choices: tuple[str, ...] = ()
    length: int | None = None
    per_uav: bool = False
    hashed: bool = True
    later: bool = False

    def is_default(self, value: Any) -> bool:
        """Whether a value is the default, of a `per_uav` array for every UAV."""
        if self.per_uav and len(self.default) == 1:
            return set(value) == set(self.default)
        return bool(value == self.default)

    @property
    def range_text(self) -> str:
        """The allowed range with its unit, for messages and documentation."""
        unit = f" {self.unit}" if self.unit else ""
        if self.choices:
            return ", ".join(self.choices)
        if self.low is None and self.high is None:
            return f"any{unit}" if unit else ""
        if self.high is None:
            return f"{'above' if self.strict else 'at least'} {self.low:.10g}{unit}"
        if self.low is None:
            return f"{'below' if self.strict else 'at most'} {self.high:.10g}{unit}"
        return f"{self.low:.10g}…{self.high:.10g}{unit}{', ends excluded' if self.strict else ''}"


def param(default: Any, doc: str, **limits: Any) -> Any:
    """Dataclass field that carries the description of a scenario key (see `Key`)."""
    return dataclasses.field(default=default, metadata={"doc": doc, **limits})


def keys_of(part: type, prefix: str) -> tuple[Key, ...]:
    """Keys of one part of the scenario, named `prefix`.field, in the order of declaration."""
    hints = get_type_hints(part)
    keys = []
    for field in dataclasses.fields(part):
        hint = hints[field.name]
        array = get_origin(hint) is tuple
        kind = _KIND_OF_TYPE[get_args(hint)[0] if array else hint]
        name = f"{prefix}.{field.name}"
        keys.append(Key(name, kind, array, field.default, **field.metadata))
    return tuple(keys)


def record_from(source: Any, kind: type[Record], **made: Any) -> Record:
    """A record of `kind` with the members that `made` has, and of the same names those of `source`.

    Raises TypeError where a member without a default is in neither.
    """
    wanted = {field.name for field in dataclasses.fields(kind)}  # type: ignore[arg-type]
    same = {field.name for field in dataclasses.fields(source)} & wanted
    return kind(**{name: getattr(source, name) for name in same - made.keys()}, **made)
