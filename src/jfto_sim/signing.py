"""MAVLink 2 signatures as the autopilot checks and makes them.

The last 6 of the 13 bytes are the head of SHA-256(key + frame + link id + time stamp); time
stamps are 48-bit counts of 10 microseconds since 2015-01-01 and must rise on each
(system, component, link). A new link may be at most one minute behind.
"""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, field

from jfto_sim.dialect import mavlink

EPOCH_2015_US = 1_420_070_400_000_000
LATE_LIMIT = 6_000_000  # one minute in 10 us units
SIGNATURE_BYTES = 13
_MAGIC_V2, _FLAG_SIGNED = 0xFD, 0x01
_UNSIGNED_OK = (mavlink.MAVLINK_MSG_ID_RADIO_STATUS, mavlink.MAVLINK_MSG_ID_RADIO)


@dataclass
class SigningKey:
    """The vehicle's key and clock, shared by its ports; it outlives a restart."""

    secret: bytes = b""
    timestamp: int = 0

    @property
    def active(self) -> bool:
        """Whether frames are signed: a key of zeros switches signing off."""
        return any(self.secret)

    def install(self, secret: bytes, timestamp: int) -> None:
        """Take a new key from SETUP_SIGNING."""
        self.secret = bytes(secret)
        self.timestamp = max(self.timestamp, timestamp)

    def advance_to(self, utc_us: float) -> None:
        """Keep the outgoing time stamp at or ahead of the vehicle's UTC."""
        self.timestamp = max(self.timestamp, int((utc_us - EPOCH_2015_US) / 10.0))


@dataclass
class SigningCheck:
    """One port's memory of time stamps."""

    key: SigningKey
    newest: dict[tuple[int, int, int], int] = field(default_factory=dict)

    def accepts(self, frame: bytes, message_id: int) -> bool:
        """Whether a port that demands signatures takes this frame."""
        if not self.key.active or message_id in _UNSIGNED_OK:
            return True
        if frame[0] != _MAGIC_V2 or not frame[2] & _FLAG_SIGNED:
            return False
        body, seal = frame[:-6], frame[-6:]
        if hashlib.sha256(self.key.secret + body).digest()[:6] != seal:
            return False
        link, stamp = frame[-SIGNATURE_BYTES], int.from_bytes(frame[-12:-6], "little")
        stream = (frame[5], frame[6], link)
        before = self.newest.get(stream)
        too_old = stamp + LATE_LIMIT < self.key.timestamp if before is None else stamp <= before
        if too_old:
            return False
        self.newest[stream] = stamp
        self.key.timestamp = max(self.key.timestamp, stamp)
        return True
