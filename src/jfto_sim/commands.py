"""COMMAND_LONG and COMMAND_INT: one record for both forms, and who carries out which command."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass

from jfto_sim.dialect import UNSUPPORTED, Message
from jfto_sim.ports import MessageHandler, Ports

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


# Carries a command out and answers with the MAV_RESULT.
CommandHandler = Callable[[Command], int]


def _unsupported(_command: Command) -> int:
    return UNSUPPORTED


def from_message(m: Message, port: int) -> Command:
    """Either form as one record."""
    p = (m.param1, m.param2, m.param3, m.param4)
    if m.get_type() == "COMMAND_INT":
        return Command(m.command, p, m.x, m.y, m.z, m.frame, port)
    scaled = [v * 1e7 if math.isfinite(v) and abs(v) <= 180 else 0.0 for v in (m.param5, m.param6)]
    return Command(m.command, p, int(scaled[0]), int(scaled[1]), m.param7, 3, port)


class Commands:
    """The commands of all parts in one table; each is acknowledged to the port it came from."""

    def __init__(self, ports: Ports, *tables: Mapping[int, CommandHandler]) -> None:
        self._ports = ports
        self._table = {number: act for table in tables for number, act in table.items()}
        self.messages: dict[str, MessageHandler] = {
            "COMMAND_LONG": self.handle,
            "COMMAND_INT": self.handle,
        }

    def handle(self, m: Message, port: int) -> None:
        """Carry out and acknowledge; unknown commands are UNSUPPORTED."""
        command = from_message(m, port)
        act = self._table.get(command.number, _unsupported)
        self._ports.acknowledge(m, port, command.number, lambda: act(command))
