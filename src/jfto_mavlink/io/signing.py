"""MAVLink 2 message signing: one key, one rising time stamp, counters of what was refused.

The key lies in a file that its owner alone can read, the last stamp used with it beside it. Source:
the signing page of the MAVLink guide. Time stamps count 10 µs since 2015-01-01 UTC.
"""

from __future__ import annotations

import hashlib
import os
import stat
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

from jfto_mavlink.dialect import mavlink
from jfto_mavlink.errors import SigningError
from jfto_mavlink.io.framing import Frame

EPOCH_S = 1_420_070_400
TICKS_PER_S = 100_000
# A stream heard for the first time may lag by this much (MAVLink guide: one minute).
NEW_STREAM_LAG = 60 * TICKS_PER_S
KEY_LENGTH = 32
# Radios report on their own behalf and cannot sign.
UNSIGNED_ALLOWED = frozenset((mavlink.MAVLINK_MSG_ID_RADIO_STATUS, mavlink.MAVLINK_MSG_ID_RADIO))

Stream = tuple[int, int, int]
# Why a frame is not believed, and the cure.
UNSIGNED = "does not sign its frames. Give it the key over a cable: jfto mission sign"
WRONG_KEY = "signs with another key than this station. Give both the same: jfto mission sign"
REPLAYED = "signs with time stamps of the past. Set its clock and this computer's"
NO_KEY = "signs its frames and answers none that are unsigned. Give the key: --key, or key_file"


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
        return not self.refusal(frame)

    def refusal(self, frame: Frame) -> str:
        """Why a received frame is not to be believed, "" if it is; counts it either way."""
        if not frame.signed:
            if frame.message.get_msgId() in UNSIGNED_ALLOWED:
                return ""
            self.counters.unsigned += 1
            return UNSIGNED
        raw = frame.raw
        if hashlib.sha256(self.key + raw[:-6]).digest()[:6] != raw[-6:]:
            self.counters.wrong += 1
            return WRONG_KEY
        stamp = int.from_bytes(raw[-12:-6], "little")
        stream = (raw[-13], frame.system, frame.component)
        last = self._streams.get(stream)
        oldest = self.floor - NEW_STREAM_LAG if last is None else last + 1
        if stamp < oldest:
            self.counters.replayed += 1
            return REPLAYED
        self._streams[stream] = stamp
        self.floor = max(self.floor, stamp)
        self.counters.good += 1
        return ""


def create_key(path: Path, passphrase: str | None = None) -> None:
    """Write a new key file with mode 0600: random, or SHA-256 of a passphrase as GCSs do it.

    Raises SigningError if the file exists.
    """
    key = hashlib.sha256(passphrase.encode()).digest() if passphrase else os.urandom(KEY_LENGTH)
    try:
        handle = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600)
    except OSError as error:
        raise SigningError(701, f"{path}: cannot be created: {error.strerror}.") from error
    with os.fdopen(handle, "w", encoding="ascii") as file:
        file.write(key.hex() + "\n")


def read_key(path: Path) -> bytes:
    """The 32-byte key of a file that holds 64 hexadecimal digits and that only its owner can read.

    Raises SigningError; the message never holds any of the file's content.
    """
    try:
        mode = path.stat().st_mode
        text = path.read_text(encoding="ascii").strip()
    except (OSError, UnicodeDecodeError) as error:
        reason = error.strerror if isinstance(error, OSError) else "it is not text"
        raise SigningError(701, f"{path}: cannot be read: {reason}.") from error
    if stat.S_IMODE(mode) & 0o077:
        raise SigningError(
            701,
            f"{path}: others may read it (mode {stat.S_IMODE(mode):04o}). Run chmod 600 {path}.",
        )
    try:
        key = bytes.fromhex(text)
    except ValueError:
        key = b""
    if len(key) != KEY_LENGTH or not any(key):
        raise SigningError(701, f"{path}: must hold 64 hexadecimal digits, not all zero.")
    return key


def load_signer(path: Path) -> Signer:
    """The signer of a key file, whose stamps never go back over restarts; raises SigningError."""
    stamps = StampFile(path)
    return Signer(read_key(path), time.time, stamps.load(), stamps.save)


class StampFile:
    """Keeps the greatest reserved time stamp beside the key, so that a restart never goes back."""

    def __init__(self, key_path: Path) -> None:
        self.path = key_path.with_name(key_path.name + ".stamp")

    def load(self) -> int:
        """The stamp kept, 0 if there is none."""
        try:
            return int(self.path.read_text(encoding="ascii"))
        except FileNotFoundError:
            return 0
        except (OSError, ValueError) as error:
            raise SigningError(
                701, f"{self.path}: cannot be read; delete it if the clock is right."
            ) from error

    def save(self, stamp: int) -> None:
        """Replace the stamp in one step, so that a crash leaves the old or the new one."""
        handle, name = tempfile.mkstemp(dir=self.path.parent, prefix=self.path.name)
        with os.fdopen(handle, "w", encoding="ascii") as file:
            file.write(f"{stamp}\n")
            file.flush()
            os.fsync(file.fileno())
        Path(name).replace(self.path)
