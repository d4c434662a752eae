"""PARAM_* messages: single reads after 100 ms, the list in under a second, silent refusals."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from jfto_sim.dialect import INFO, WARNING, Message, mavlink

if TYPE_CHECKING:
    from jfto_sim.vehicle import Vehicle

NO_INDEX = 65535
_READ_PERIOD_S = 0.1
_READ_PHASE_S = 0.01
_LIST_PERIOD_S = 0.02
_LIST_BURST = 31
_BANNER = ("ArduCopter V4.5.5 (142aece2)", "3d1219c7c4c5404aaa1f6d2a48adfda4", "Frame: QUAD/PLUS")


class ParameterProtocol:
    """Queues of pending reads and lists, served as the vehicle's clock passes."""

    def __init__(self, vehicle: Vehicle) -> None:
        self.vehicle = vehicle
        self._reads: list[tuple[int, str, int]] = []
        self._lists: dict[int, int] = {}
        self._list_s = float("inf")
        self._read_s = float("inf")

    @property
    def next_s(self) -> float:
        """When something is to be sent next."""
        return min(self._read_s, self._list_s)

    def tick(self) -> None:
        """Send what is due."""
        now = self.vehicle.time_s + 1e-9
        if now >= self._read_s:
            for port, name, index in self._reads:
                self._send(name, index, port)
            self._reads.clear()
            self._read_s = float("inf")
        if now >= self._list_s:
            self._list_s += _LIST_PERIOD_S
            self._send_list()

    def _send_list(self) -> None:
        v = self.vehicle
        for port, at in list(self._lists.items()):
            stop = min(at + _LIST_BURST, v.params.count)
            for index in range(at, stop):
                name = v.params.name_at(index)
                assert name is not None
                self._send(name, index, port)
            if stop >= v.params.count:
                del self._lists[port]
            else:
                self._lists[port] = stop
        if not self._lists:
            self._list_s = float("inf")

    def _send(self, name: str, index: int, port: int, count: int | None = None) -> None:
        self.vehicle.send(port, self.message(name, index, count))

    def message(self, name: str, index: int = NO_INDEX, count: int | None = None) -> Message:
        """PARAM_VALUE of one parameter."""
        params = self.vehicle.params
        return mavlink.MAVLink_param_value_message(
            name.encode(), params[name], params.kind(name), count or params.count, index
        )

    def request_read(self, m: Message, port: int) -> None:
        """PARAM_REQUEST_READ by name or index; unknown ones are not answered."""
        v = self.vehicle
        if m.param_index == -1:
            name: str | None = _name(m)
        else:
            name = v.params.name_at(m.param_index)
        if name is None or name not in v.params:
            return
        index = NO_INDEX if m.param_index == -1 else m.param_index
        self._reads.append((port, name, index))
        if self._read_s == float("inf"):
            beat = math.floor((v.time_s - _READ_PHASE_S) / _READ_PERIOD_S + 1e-6) + 1
            self._read_s = beat * _READ_PERIOD_S + _READ_PHASE_S

    def request_list(self, port: int) -> None:
        """PARAM_REQUEST_LIST: the banner, then every parameter."""
        v = self.vehicle
        for line in _BANNER:
            v.text(INFO, line, port)
        self._lists[port] = 0
        if self._list_s == float("inf"):
            self._list_s = v.time_s + _LIST_PERIOD_S

    def set(self, m: Message, port: int) -> None:
        """PARAM_SET: echoed on every active port with what was stored."""
        v = self.vehicle
        name = _name(m)
        if name not in v.params or not math.isfinite(m.param_value):
            return
        if v.params.read_only(name):
            self._send(name, NO_INDEX, port)
            v.text(WARNING, f"Param write denied ({name})", port)
            return
        v.params.store(name, m.param_value)
        v.tell_parameter(name)
        v.parameter_changed(name)


def _name(m: Message) -> str:
    name = m.param_id
    return name.rstrip("\x00") if isinstance(name, str) else name.decode("ascii", "replace")
