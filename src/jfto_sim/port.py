"""One serial port of the vehicle: framing in both directions, signing, message intervals."""

from __future__ import annotations

import heapq
from dataclasses import dataclass, field
from typing import Any

from jfto_sim.dialect import Message, mavlink, mavlink1
from jfto_sim.signing import SigningCheck, SigningKey


def _without_extensions(message: Message) -> Message:
    """The message as MAVLink 1 knows it: the fields that MAVLink 2 added are left out."""
    old = mavlink1.mavlink_map[message.get_msgId()]
    values = [getattr(message, f"_{name}_raw", None) for name in old.fieldnames]
    return old(
        *(
            getattr(message, name) if raw is None else raw
            for name, raw in zip(old.fieldnames, values, strict=True)
        )
    )


@dataclass
class Interval:
    """How often one message goes out on one port; the next time it is due."""

    period_s: float
    due_s: float


@dataclass
class Port:
    """State of one port. `active` becomes true when something valid is heard on it.

    The first port takes every frame, signed or not, as the autopilot's USB port does. `intervals`
    maps message ids to their periods and is lost at a restart, like everything here.
    """

    index: int
    sysid: int
    key: SigningKey
    mavlink1: bool = False
    active: bool = False
    intervals: dict[int, Interval] = field(default_factory=dict)
    heap: list[tuple[float, int]] = field(default_factory=list)
    refused: int = 0
    _codec: Any = None
    _reader: Any = None
    _check: SigningCheck | None = None

    def __post_init__(self) -> None:
        self._codec = mavlink.MAVLink(None, srcSystem=self.sysid, srcComponent=1)
        # apart from the writer, whose key would make the library check signatures by itself
        self._reader = mavlink.MAVLink(None)
        self._reader.robust_parsing = True
        self._check = SigningCheck(self.key)

    def decode(self, data: bytes) -> list[Message]:
        """Valid messages in a chunk of bytes; noise and refused frames are counted, not raised."""
        messages = []
        for message in self._reader.parse_buffer(data) or []:
            if message.get_type() == "BAD_DATA" or not self._allowed(message):
                self.refused += 1
                continue
            self.active = True
            messages.append(message)
        return messages

    def _allowed(self, message: Message) -> bool:
        assert self._check is not None
        taken = self._check.accepts(bytes(message.get_msgbuf()), message.get_msgId())
        return taken or self.index == 0

    def encode(self, message: Message) -> bytes:
        """The frame of an outgoing message, or nothing where MAVLink 1 cannot carry it."""
        if self.mavlink1 and message.get_msgId() not in mavlink1.mavlink_map:
            return b""
        signing = self._codec.signing
        signing.sign_outgoing = self.key.active and not self.mavlink1
        if signing.sign_outgoing:
            signing.secret_key, signing.link_id = self.key.secret, self.index
            signing.timestamp = self.key.timestamp
        if self.mavlink1:
            frame = bytes(_without_extensions(message).pack(self._codec, force_mavlink1=True))
        else:
            frame = bytes(message.pack(self._codec))
        if signing.sign_outgoing:
            self.key.timestamp = max(self.key.timestamp + 1, signing.timestamp)
        self._codec.seq = (self._codec.seq + 1) % 256
        return frame

    def set_interval(self, message_id: int, period_s: float, now_s: float) -> None:
        """Send a message every `period_s` from now on; 0 or less stops it."""
        if period_s <= 0:
            self.intervals.pop(message_id, None)
            return
        due = now_s + period_s
        self.intervals[message_id] = Interval(period_s, due)
        heapq.heappush(self.heap, (due, message_id))

    def next_due_s(self) -> float:
        """When the next streamed message is due, infinite if none is."""
        while self.heap:
            due, message_id = self.heap[0]
            interval = self.intervals.get(message_id)
            if interval is not None and interval.due_s == due:
                return due
            heapq.heappop(self.heap)
        return float("inf")

    def pop_due(self, now_s: float) -> list[int]:
        """Ids of the messages that are due, in order; their next times are set."""
        ready = []
        while self.next_due_s() <= now_s + 1e-9:
            due, message_id = heapq.heappop(self.heap)
            interval = self.intervals[message_id]
            interval.due_s = due + interval.period_s
            heapq.heappush(self.heap, (interval.due_s, message_id))
            ready.append(message_id)
        return ready
