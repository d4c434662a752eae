"""What happened in flight and what was done about it, one line each for the operator."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from jfto_msgs_py.errors import MessageError
from jfto_msgs_py.ros.stamps import decode_time, encode_time

# Levels, as rcl_interfaces/Log has them.
DEBUG, INFO, WARN, ERROR, FATAL = 10, 20, 30, 40, 50

# What an event may be about. Readers take others too: a node may be newer than they are.
KINDS = {
    "k_min": "a UAV has, or will have, fewer radio neighbours than asked for",
    "d_min": "two UAVs come, or will come, closer than allowed",
    "connectivity": "the fleet falls, or will fall, into parts",
    "energy": "a UAV's radio cannot pay for what is left of the mission",
    "late": "UAVs run late, or the slots were shifted",
    "stale": "no fresh pose of a UAV",
    "topology": "the topology is silent",
    "power": "powers could not be solved",
    "radio": "a radio failed to take its power",
    "vehicle": "a vehicle was lost, or came back",
    "gps": "a vehicle lost its position, or has it again",
    "battery": "a flight battery runs low",
    "link": "the link to a vehicle broke, or is back",
    "restart": "a node died and was started again",
    "order": "the conductor of a run ordered something, or heard what came of it",
    "lift_off": "the flight began",
    "mode": "a vehicle changed its flight mode, which nobody ordered here",
    "fence": "a vehicle left its fence",
    "failsafe": "another failsafe of a vehicle acted",
    "done": "a UAV has passed all its waypoints",
    "unvisited": "a UAV has left its mission, and waypoints with it",
    "landed": "a UAV, or the fleet, is down and disarmed",
}


@dataclass(frozen=True)
class Event:
    """One event: `kind` is one of KINDS, `uav_id` "" where it is about no single UAV.

    `stamp_ns` is on the clock of `node` (ns since the epoch), `level` DEBUG … FATAL, `text` one
    line. Raises MessageError where that does not hold.
    """

    stamp_ns: int
    level: int
    node: str
    kind: str
    uav_id: str
    text: str

    def __post_init__(self) -> None:
        if self.level not in {DEBUG, INFO, WARN, ERROR, FATAL}:
            raise MessageError("level", f"is {self.level}, must be 10, 20, 30, 40 or 50")
        if not self.kind:
            raise MessageError("function", "is empty, must say the kind of event")
        if not self.text or "\n" in self.text:
            raise MessageError("msg", f"{self.text!r} is not one line")


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
        decode_time(message.stamp, "stamp"),
        int(message.level),
        message.name,
        message.function,
        message.file,
        message.msg,
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
