"""One command, whichever of the two messages carried it."""

from __future__ import annotations

import math
from dataclasses import dataclass

from jfto_sim.dialect import Message

_WHOLE_MAX = 2.0**31


@dataclass(frozen=True)
class Command:
    """One command in either message form; position in 1e-7 degree."""

    number: int
    p: tuple[float, float, float, float]
    x: int
    y: int
    z: float
    frame: int
    port: int

    def whole(self, k: int) -> int:
        """Parameter k (from 0) as a whole number, 0 where it is not one."""
        value = self.p[k]
        return int(value) if abs(value) < _WHOLE_MAX else 0


def from_message(m: Message, port: int) -> Command:
    """Either form as one record."""
    p = (m.param1, m.param2, m.param3, m.param4)
    if m.get_type() == "COMMAND_INT":
        return Command(m.command, p, m.x, m.y, m.z, m.frame, port)
    scaled = [v * 1e7 if math.isfinite(v) and abs(v) <= 180 else 0.0 for v in (m.param5, m.param6)]
    return Command(m.command, p, int(scaled[0]), int(scaled[1]), m.param7, 3, port)
