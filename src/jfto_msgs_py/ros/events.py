"""Events as messages, and what keeps them from flooding anybody."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from jfto_msgs_py.records.event import Event
from jfto_msgs_py.ros.stamps import decode_time, encode_time


def encode_event(event: Event) -> Any:
    """rcl_interfaces/Log of an event: kind as `function`, UAV as `file`."""
    from rcl_interfaces.msg import Log

    return Log(
        stamp=encode_time(event.stamp_ns),
        level=event.level,
        name=event.node,
        msg=event.text,
        file=event.uav_id,
        function=event.kind,
        line=0,
    )


def decode_event(message: Any) -> Event:
    """Event in an rcl_interfaces/Log. Raises MessageError naming the field at fault."""
    return Event(
        int(message.level),
        message.function,
        message.file,
        message.msg,
        decode_time(message.stamp, "stamp"),
        message.name,
    )


class EventLimit:
    """Keeps one trouble from flooding the operator: `BURST` at once, then one each `EVERY_S`.

    Counted per kind and UAV on `seconds`, a clock that does not jump.
    """

    BURST = 10
    EVERY_S = 2.0

    def __init__(self, seconds: Callable[[], float]) -> None:
        self._seconds = seconds
        self._state: dict[tuple[str, str], tuple[float, float, int]] = {}

    def admit(self, kind: str, uav_id: str) -> int | None:
        """How many were held back since the last one; None where this one is held back too."""
        now_s = self._seconds()
        left, since_s, held = self._state.get((kind, uav_id), (float(self.BURST), now_s, 0))
        left = min(left + (now_s - since_s) / self.EVERY_S, float(self.BURST))
        admitted = left >= 1
        self._state[kind, uav_id] = (left - 1, now_s, 0) if admitted else (left, now_s, held + 1)
        return held if admitted else None
