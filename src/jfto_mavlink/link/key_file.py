"""The signing key on disk, readable by its owner alone, and the last time stamp used with it."""

from __future__ import annotations

import hashlib
import os
import stat
import tempfile
from pathlib import Path

from jfto_mavlink.errors import SigningError
from jfto_mavlink.link.signing import KEY_LENGTH


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
