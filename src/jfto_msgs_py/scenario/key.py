"""One scenario key: what it holds, in which unit, within which range."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import Any, get_args, get_origin, get_type_hints

_KIND_OF_TYPE = {bool: "bool", int: "int", float: "float", str: "text"}


@dataclass(frozen=True)
class Key:
    """Description of one scenario key.

    `kind` is "bool", "int", "float" or "text"; `array` says that it holds a list, of `length`
    entries where that is fixed. A `per_uav` array has one entry per UAV, or one for all of them.
    `low` and `high` bound every entry, and are themselves allowed unless `strict`. `choices` lists
    the allowed texts. A key that is not `hashed` cannot change a result for a given seed.
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
