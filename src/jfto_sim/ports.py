"""The vehicle's serial ports: framing in both directions, signing, message intervals, sending."""

from __future__ import annotations

import heapq
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

from pymavlink.dialects.v10 import ardupilotmega as mavlink1

from jfto_sim.clock import Clock
from jfto_sim.dialect import TEXT_LENGTH, Message, mavlink
from jfto_sim.signing import SigningCheck, SigningKey

# A port's number and the bytes that leave through it.
Frame = tuple[int, bytes]
# Acts on a message that came in on a port.
MessageHandler = Callable[[Message, int], None]

_BEFORE_ACKNOWLEDGEMENT = "MESSAGE_INTERVAL"


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


class Port:
    """State of one port. `active` becomes true when something valid is received on it.

    The first port takes every frame, signed or not, as the autopilot's USB port does. `intervals`
    maps message ids to their periods and is lost at a restart, like everything here.
    """

    def __init__(self, index: int, sysid: int, key: SigningKey, *, mavlink1: bool = False) -> None:
        self.index = index
        self.key = key
        self.mavlink1 = mavlink1
        self.active = False
        self.refused = 0
        self.intervals: dict[int, Interval] = {}
        self._heap: list[tuple[float, int]] = []
        self._codec = mavlink.MAVLink(None, srcSystem=sysid, srcComponent=1)
        # apart from the writer, whose key would make the library check signatures by itself
        self._reader = mavlink.MAVLink(None)
        self._reader.robust_parsing = True
        self._check = SigningCheck(key)

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
        heapq.heappush(self._heap, (due, message_id))

    def next_due_s(self) -> float:
        """When the next streamed message is due, infinite if none is."""
        while self._heap:
            due, message_id = self._heap[0]
            interval = self.intervals.get(message_id)
            if interval is not None and interval.due_s == due:
                return due
            heapq.heappop(self._heap)
        return float("inf")

    def pop_due(self, now_s: float) -> list[int]:
        """Ids of the messages that are due, in order; their next times are set."""
        ready = []
        while self.next_due_s() <= now_s + 1e-9:
            due, message_id = heapq.heappop(self._heap)
            interval = self.intervals[message_id]
            interval.due_s = due + interval.period_s
            heapq.heappush(self._heap, (interval.due_s, message_id))
            ready.append(message_id)
        return ready


@dataclass
class Ports:
    """All ports of a vehicle. What is sent through them is appended to `out`, in order."""

    ports: Sequence[Port]
    key: SigningKey
    clock: Clock
    out: list[Frame]
    _held: list[tuple[int, Message]] | None = None

    def __getitem__(self, index: int) -> Port:
        return self.ports[index]

    def __iter__(self) -> Iterator[Port]:
        return iter(self.ports)

    def __len__(self) -> int:
        return len(self.ports)

    def send(self, port: int, message: Message) -> None:
        """Send a message on one port."""
        if self._held is not None and message.get_type() != _BEFORE_ACKNOWLEDGEMENT:
            self._held.append((port, message))
            return
        if self.key.active:
            self.key.advance_to(self.clock.utc_us)
        frame = self.ports[port].encode(message)
        if frame:
            self.out.append((port, frame))

    def broadcast(self, message: Message, *, everywhere: bool = False) -> None:
        """Send on every port on which something has been received, or on all."""
        for port in self.ports:
            if everywhere or port.active:
                self.send(port.index, message)

    def text(self, severity: int, text: str, port: int | None = None) -> None:
        """STATUSTEXT to one port or to all active ones."""
        message = mavlink.MAVLink_statustext_message(severity, text.encode()[:TEXT_LENGTH])
        if port is None:
            self.broadcast(message)
        else:
            self.send(port, message)

    def acknowledge(self, m: Message, port: int, number: int, action: Callable[[], int]) -> None:
        """Carry out a command; its COMMAND_ACK goes out before all that is sent meanwhile."""
        self._held = []
        result = action()
        held, self._held = self._held, None
        sender = (m.get_srcSystem(), m.get_srcComponent())
        self.send(port, mavlink.MAVLink_command_ack_message(number, result, 0, 0, *sender))
        for at, message in held:
            self.send(at, message)
