"""PARAM_* messages: single reads after 100 ms, the list in under a second, silent refusals."""

from __future__ import annotations

import math
from collections.abc import Callable

from jfto_sim.clock import Clock
from jfto_sim.dialect import INFO, WARNING, Message, mavlink
from jfto_sim.parameters import Parameters
from jfto_sim.ports import MessageHandler, Ports

NO_INDEX = 65535
_READ_PERIOD_S = 0.1
_READ_PHASE_S = 0.01
_LIST_PERIOD_S = 0.02
_LIST_BURST = 31
_BANNER = ("ArduCopter V4.5.5 (142aece2)", "3d1219c7c4c5404aaa1f6d2a48adfda4", "Frame: QUAD/PLUS")
_NEVER_S = float("inf")


class ParameterProtocol:
    """Queues of pending reads and lists, served as the vehicle's clock passes.

    `changed` is told the name of a parameter that a station wrote.
    """

    def __init__(
        self, params: Parameters, clock: Clock, ports: Ports, changed: Callable[[str], None]
    ) -> None:
        self.params = params
        self._clock = clock
        self._ports = ports
        self._changed = changed
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
        now = self._clock.time_s + 1e-9
        if now >= self._read_s:
            for port, name, index in self._reads:
                self._ports.send(port, self._message(name, index))
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
                self._ports.send(port, self._message(name, index))
            if stop >= self.params.count:
                del self._lists[port]
            else:
                self._lists[port] = stop
        if not self._lists:
            self._list_s = _NEVER_S

    def _message(self, name: str, index: int = NO_INDEX, count: int | None = None) -> Message:
        params = self.params
        return mavlink.MAVLink_param_value_message(
            name.encode(), params[name], params.kind(name), count or params.count, index
        )

    def tell(self, name: str, count: int | None = None) -> None:
        """PARAM_VALUE to every active port; `count` is how many parameters there are by then."""
        self._ports.broadcast(self._message(name, count=count))

    def tell_stored(self, name: str, value: float) -> None:
        """Store a value of the vehicle's own and tell it."""
        self.params.store(name, value)
        self.tell(name)

    def _request_read(self, m: Message, port: int) -> None:
        """By name or index; unknown ones are not answered."""
        by_name = m.param_index == -1
        name = _name(m) if by_name else self.params.name_at(m.param_index)
        if name is None or name not in self.params:
            return
        self._reads.append((port, name, NO_INDEX if by_name else m.param_index))
        if self._read_s == _NEVER_S:
            beat = math.floor((self._clock.time_s - _READ_PHASE_S) / _READ_PERIOD_S + 1e-6) + 1
            self._read_s = beat * _READ_PERIOD_S + _READ_PHASE_S

    def _request_list(self, _m: Message, port: int) -> None:
        """The banner, then every parameter."""
        for line in _BANNER:
            self._ports.text(INFO, line, port)
        self._lists[port] = 0
        if self._list_s == _NEVER_S:
            self._list_s = self._clock.time_s + _LIST_PERIOD_S

    def _set(self, m: Message, port: int) -> None:
        """Echoed on every active port with what was stored."""
        name = _name(m)
        if name not in self.params or not math.isfinite(m.param_value):
            return
        if self.params.read_only(name):
            self._ports.send(port, self._message(name))
            self._ports.text(WARNING, f"Param write denied ({name})", port)
            return
        self.tell_stored(name, m.param_value)
        self._changed(name)


def _name(m: Message) -> str:
    name = m.param_id
    return name.rstrip("\x00") if isinstance(name, str) else name.decode("ascii", "replace")
