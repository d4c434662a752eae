"""The vehicle's parameters: ArduCopter 4.5.5's list with its defaults, typed storage, protocol.

Values travel as 32-bit floats whatever the type, as ArduPilot sends them.
"""

from __future__ import annotations

import csv
import math
import struct
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from importlib.resources import files

from jfto_msgs_py.errors import InputError
from jfto_sim.clock import Clock
from jfto_sim.dialect import INFO, WARNING, Message, mavlink
from jfto_sim.ports import MessageHandler, Ports

INT8, INT16, INT32, REAL32 = 2, 4, 6, 9
_RANGE = {INT8: 8, INT16: 16, INT32: 32}
_NO_INDEX = 65535
_READ_PERIOD_S, _READ_PHASE_S = 0.1, 0.01
_LIST_PERIOD_S, _LIST_BURST = 0.02, 31
_BANNER = ("ArduCopter V4.5.5 (142aece2)", "3d1219c7c4c5404aaa1f6d2a48adfda4", "Frame: QUAD/PLUS")
_NEVER_S = float("inf")
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


@dataclass
class ParameterProtocol:
    """PARAM_* messages: single reads after 100 ms, the list in under a second, silent refusals.

    `changed` is told the name of a parameter that a station wrote.
    """

    params: Parameters
    clock: Clock
    ports: Ports
    changed: Callable[[str], None]

    def __post_init__(self) -> None:
        self._reads: list[tuple[int, str, int]] = []
        self._lists: dict[int, int] = {}
        self._list_s = self._read_s = _NEVER_S
        self.messages: dict[str, MessageHandler] = {
            "PARAM_REQUEST_READ": self._request_read,
            "PARAM_REQUEST_LIST": self._request_list,
            "PARAM_SET": self._set,
        }

    @property
    def next_s(self) -> float:
        """When something is to be sent next."""
        return min(self._read_s, self._list_s)

    def tick(self) -> None:
        """Send what is due."""
        now = self.clock.time_s + 1e-9
        if now >= self._read_s:
            for port, name, index in self._reads:
                self.ports.send(port, self._message(name, index))
            self._reads.clear()
            self._read_s = _NEVER_S
        if now >= self._list_s:
            self._list_s += _LIST_PERIOD_S
            self._send_lists()

    def _send_lists(self) -> None:
        for port, at in list(self._lists.items()):
            stop = min(at + _LIST_BURST, self.params.count)
            for index in range(at, stop):
                name = self.params.name_at(index)
                assert name is not None
                self.ports.send(port, self._message(name, index))
            if stop >= self.params.count:
                del self._lists[port]
            else:
                self._lists[port] = stop
        if not self._lists:
            self._list_s = _NEVER_S

    def _message(self, name: str, index: int = _NO_INDEX, count: int | None = None) -> Message:
        params = self.params
        return mavlink.MAVLink_param_value_message(
            name.encode(), params[name], params.kind(name), count or params.count, index
        )

    def announce(self, name: str, count: int | None = None) -> None:
        """PARAM_VALUE to every active port; `count` is how many parameters there are by then."""
        self.ports.broadcast(self._message(name, count=count))

    def store_and_announce(self, name: str, value: float) -> None:
        """Store a value and announce it."""
        self.params.store(name, value)
        self.announce(name)

    def _request_read(self, m: Message, port: int) -> None:
        """By name or index; unknown ones are not answered."""
        by_name = m.param_index == -1
        name = _name(m) if by_name else self.params.name_at(m.param_index)
        if name is None or name not in self.params:
            return
        self._reads.append((port, name, _NO_INDEX if by_name else m.param_index))
        if self._read_s == _NEVER_S:
            beat = math.floor((self.clock.time_s - _READ_PHASE_S) / _READ_PERIOD_S + 1e-6) + 1
            self._read_s = beat * _READ_PERIOD_S + _READ_PHASE_S

    def _request_list(self, _m: Message, port: int) -> None:
        """The banner, then every parameter."""
        for line in _BANNER:
            self.ports.text(INFO, line, port)
        self._lists[port] = 0
        if self._list_s == _NEVER_S:
            self._list_s = self.clock.time_s + _LIST_PERIOD_S

    def _set(self, m: Message, port: int) -> None:
        """Echoed on every active port with what was stored."""
        name = _name(m)
        if name not in self.params or not math.isfinite(m.param_value):
            return
        if self.params.read_only(name):
            self.ports.send(port, self._message(name))
            self.ports.text(WARNING, f"Param write denied ({name})", port)
            return
        self.store_and_announce(name, m.param_value)
        self.changed(name)


def _name(m: Message) -> str:
    name = m.param_id
    return name.rstrip("\x00") if isinstance(name, str) else name.decode("ascii", "replace")
