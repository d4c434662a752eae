"""Cut MAVLink frames out of a stream of bytes that may hold anything else."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from jfto_mavlink.dialect import Message, mavlink

MAGIC_V1, MAGIC_V2 = 0xFE, 0xFD
SIGNED = mavlink.MAVLINK_IFLAG_SIGNED
SIGNATURE_LENGTH = mavlink.MAVLINK_SIGNATURE_BLOCK_LEN
_STARTS = bytes((MAGIC_V1, MAGIC_V2))


@dataclass(frozen=True)
class Frame:
    """One frame as received, and the message in it."""

    raw: bytes
    message: Message

    @property
    def signed(self) -> bool:
        """Whether the frame carries a signature block."""
        return self.raw[0] == MAGIC_V2 and bool(self.raw[2] & SIGNED)

    @property
    def system(self) -> int:
        """System id of the sender."""
        return self.message.get_srcSystem()

    @property
    def component(self) -> int:
        """Component id of the sender."""
        return self.message.get_srcComponent()


class Framer:
    """Turns received bytes into frames; what is not a frame is skipped byte by byte and counted.

    pymavlink's own stream parser throws away a whole supposed frame when its checksum is wrong, and
    with it the good frames inside. This one goes on one byte after the false start.
    """

    def __init__(self) -> None:
        self._buffer = bytearray()
        self._codec = mavlink.MAVLink(None)
        self.noise_bytes = 0
        self.bad_frames = 0
        self.unknown_frames = 0

    def feed(self, data: bytes) -> Iterator[Frame]:
        """Frames completed by `data`, in order."""
        buffer = self._buffer
        buffer += data
        start = 0
        while True:
            at = _next_start(buffer, start)
            self.noise_bytes += at - start
            start = at
            length = frame_length(buffer, start)
            if length is None or start + length > len(buffer):
                break
            raw = bytes(buffer[start : start + length])
            message = self._decode(raw)
            if message is None:
                start += 1
                self.noise_bytes += 1
                continue
            start += length
            yield Frame(raw, message)
        del buffer[:start]

    def _decode(self, raw: bytes) -> Message | None:
        if raw[0] == MAGIC_V2 and raw[2] & ~SIGNED:
            self.bad_frames += 1
            return None
        try:
            message = self._codec.decode(bytearray(raw))
        except mavlink.MAVError:
            self.bad_frames += 1
            return None
        if isinstance(message, mavlink.MAVLink_unknown):
            # Its checksum cannot be tested, so it may be a false start.
            self.unknown_frames += 1
            return None
        return message


def _next_start(buffer: bytearray, start: int) -> int:
    candidates = [at for at in (buffer.find(magic, start) for magic in _STARTS) if at >= 0]
    return min(candidates, default=len(buffer))


def frame_length(buffer: bytes | bytearray, start: int) -> int | None:
    """Length of the frame that begins at `start`; None while its header is incomplete."""
    if start + 3 > len(buffer):
        return None
    payload = buffer[start + 1]
    if buffer[start] == MAGIC_V1:
        return 8 + payload
    return 12 + payload + (SIGNATURE_LENGTH if buffer[start + 2] & SIGNED else 0)
