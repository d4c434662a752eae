"""One link with its frames: who is heard where, sequence numbers, signatures, counters."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable
from dataclasses import dataclass, field

from jfto_mavlink.dialect import Message, mavlink
from jfto_mavlink.io.address import LinkAddress
from jfto_mavlink.io.framing import Frame, Framer
from jfto_mavlink.io.signing import Signer
from jfto_mavlink.io.transport import Peer, SerialTransport, TcpTransport, Transport, UdpTransport

# Peers kept per listening socket; more would let a flood of forged senders grow memory.
PEERS_MAX = 64


@dataclass(frozen=True)
class Station:
    """How this station names itself on the wire."""

    system: int = 255
    component: int = 191


@dataclass
class PortCounters:
    """Traffic of one link."""

    frames_in: int = 0
    frames_out: int = 0
    bytes_in: int = 0
    refused_signature: int = 0
    # Frames missing by the sequence numbers, per sender.
    lost: dict[tuple[int, int], int] = field(default_factory=dict)


class Port:
    """A link that speaks MAVLink. `index` is its link id in signatures.

    `transport` replaces the one that the address names, for links that exist in memory only.
    `refused` is told of each frame that is not believed, and why.
    """

    def __init__(
        self,
        address: LinkAddress,
        station: Station,
        index: int,
        signer: Signer | None = None,
        transport: Transport | None = None,
        refused: Callable[[Frame, str], None] = lambda _frame, _why: None,
    ) -> None:
        self.address = address
        self.signer = signer
        self.counters = PortCounters()
        self.transport = transport or open_transport(address)
        self._index = index
        self._refused = refused
        self._codec = mavlink.MAVLink(None, station.system, station.component)
        self._framers: OrderedDict[Peer, Framer] = OrderedDict()
        self._last_sequence: dict[tuple[int, int], int] = {}

    def receive(self) -> list[tuple[Peer, Frame]]:
        """Frames that arrived and, with signing on, may be believed."""
        frames: list[tuple[Peer, Frame]] = []
        for peer, data in self.transport.receive():
            self.counters.bytes_in += len(data)
            for frame in self._framer(peer).feed(data):
                refusal = "" if self.signer is None else self.signer.refusal(frame)
                if refusal:
                    self.counters.refused_signature += 1
                    self._refused(frame, refusal)
                    continue
                self._count(frame)
                frames.append((peer, frame))
        return frames

    def pack(self, message: Message) -> bytes:
        """Bytes of a message as sent now: next sequence number, fresh signature."""
        if self.signer is not None:
            self.signer.prepare(self._codec, self._index)
        raw = message.pack(self._codec)
        self._codec.seq = (self._codec.seq + 1) % 256
        return raw

    def send(self, message: Message, peer: Peer = None) -> bytes:
        """Send to one peer; returns the frame."""
        raw = self.pack(message)
        self.transport.send(raw, peer)
        self.counters.frames_out += 1
        return raw

    @property
    def bad_frames(self) -> int:
        """Frames with a wrong checksum or form."""
        return sum(framer.bad_frames for framer in self._framers.values())

    def _framer(self, peer: Peer) -> Framer:
        framer = self._framers.get(peer)
        if framer is None:
            framer = self._framers[peer] = Framer()
            if len(self._framers) > PEERS_MAX:
                self._framers.popitem(last=False)
        else:
            self._framers.move_to_end(peer)
        return framer

    def _count(self, frame: Frame) -> None:
        counters = self.counters
        counters.frames_in += 1
        sender = (frame.system, frame.component)
        sequence = frame.message.get_seq()
        last = self._last_sequence.get(sender)
        self._last_sequence[sender] = sequence
        if last is not None:
            gap = (sequence - last - 1) % 256
            # A great gap is a restart or an old frame, not 200 lost ones.
            if gap < 128:
                counters.lost[sender] = counters.lost.get(sender, 0) + gap


def open_transport(address: LinkAddress) -> Transport:
    """The transport of a link's kind."""
    if address.kind in ("udpin", "udpout"):
        return UdpTransport(address)
    return TcpTransport(address) if address.kind == "tcp" else SerialTransport(address)
