"""MAVLink 2 message signing: one key, one rising time stamp, counters of what was refused.

Source: the signing page of the MAVLink guide. Time stamps count 10 µs since 2015-01-01 UTC.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from dataclasses import dataclass, field

from jfto_mavlink.dialect import mavlink
from jfto_mavlink.link.framing import Frame

EPOCH_S = 1_420_070_400
TICKS_PER_S = 100_000
# A stream heard for the first time may lag by this much (MAVLink guide: one minute).
NEW_STREAM_LAG = 60 * TICKS_PER_S
KEY_LENGTH = 32
# Radios report on their own behalf and cannot sign.
UNSIGNED_ALLOWED = frozenset((mavlink.MAVLINK_MSG_ID_RADIO_STATUS, mavlink.MAVLINK_MSG_ID_RADIO))

Stream = tuple[int, int, int]


def ticks(unix_s: float) -> int:
    """Signing time stamp of a Unix time in seconds."""
    return int((unix_s - EPOCH_S) * TICKS_PER_S)


@dataclass
class SigningCounters:
    """How many frames arrived in each condition while signing was on."""

    good: int = 0
    unsigned: int = 0
    wrong: int = 0
    replayed: int = 0

    @property
    def refused(self) -> int:
        """Frames that were ignored."""
        return self.unsigned + self.wrong + self.replayed


@dataclass
class Signer:
    """Key and time stamps of the station; shared by all links, so that stamps rise on each.

    `clock` gives Unix seconds; `floor` is the least stamp allowed, for example one kept from the
    last run; `persist` is told each new reservation of stamps before the first of it is used.
    """

    key: bytes = field(repr=False)
    clock: Callable[[], float]
    floor: int = 0
    persist: Callable[[int], None] | None = None
    counters: SigningCounters = field(default_factory=SigningCounters)
    _streams: dict[Stream, int] = field(default_factory=dict)
    _reserved: int = 0

    RESERVE = 10 * TICKS_PER_S

    def __post_init__(self) -> None:
        if len(self.key) != KEY_LENGTH:
            raise ValueError("a signing key has 32 bytes")

    def next_stamp(self) -> int:
        """A stamp greater than any before, also of earlier runs and of stations heard."""
        self.floor = max(self.floor + 1, ticks(self.clock()))
        if self.persist is not None and self.floor >= self._reserved:
            self._reserved = self.floor + self.RESERVE
            self.persist(self._reserved)
        return self.floor

    def prepare(self, codec: mavlink.MAVLink, link_id: int) -> None:
        """Make `codec` sign the next message it packs, with a fresh stamp."""
        codec.signing.secret_key = self.key
        codec.signing.sign_outgoing = True
        codec.signing.link_id = link_id
        codec.signing.timestamp = self.next_stamp()

    def accepts(self, frame: Frame) -> bool:
        """Whether a received frame may be believed; counts it either way."""
        if not frame.signed:
            if frame.message.get_msgId() in UNSIGNED_ALLOWED:
                return True
            self.counters.unsigned += 1
            return False
        raw = frame.raw
        if hashlib.sha256(self.key + raw[:-6]).digest()[:6] != raw[-6:]:
            self.counters.wrong += 1
            return False
        stamp = int.from_bytes(raw[-12:-6], "little")
        stream = (raw[-13], frame.system, frame.component)
        last = self._streams.get(stream)
        oldest = self.floor - NEW_STREAM_LAG if last is None else last + 1
        if stamp < oldest:
            self.counters.replayed += 1
            return False
        self._streams[stream] = stamp
        self.floor = max(self.floor, stamp)
        self.counters.good += 1
        return True
