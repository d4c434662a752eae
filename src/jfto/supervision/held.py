"""One graph a directory: its plan, its energy account and its logs are not for two."""

from __future__ import annotations

import fcntl
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from jfto_msgs_py.errors import InputError

LOCK_NAME = ".in-use"


@contextmanager
def held(directory: Path) -> Iterator[None]:
    """Keep others out for as long as the context lasts, or this process; raises InputError.

    The kernel gives the directory free however the process ends.
    """
    with (directory / LOCK_NAME).open("a+", encoding="ascii") as lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            lock.seek(0)
            owner = lock.read().strip() or "unknown"
            raise InputError(
                f"{directory}: another graph writes there (process {owner}). End it, or name "
                "another directory with --out. Nothing was started."
            ) from None
        lock.seek(0)
        lock.truncate()
        lock.write(f"{os.getpid()}\n")
        lock.flush()
        yield
