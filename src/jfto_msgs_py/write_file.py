"""Writing files so that nobody ever sees half of one."""

from __future__ import annotations

import contextlib
import os
from pathlib import Path

from jfto_msgs_py.errors import InputError


def write_file(path: Path, content: str | bytes) -> None:
    """Write to a temporary name beside `path`, then rename; text goes out as UTF-8.

    Raises InputError where the file cannot be written.
    """
    data = content.encode() if isinstance(content, str) else content
    temporary = path.with_name(f".{path.name}.{os.getpid()}.tmp")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        temporary.write_bytes(data)
        temporary.replace(path)
    except OSError as cause:
        # Where even the half-written file cannot be removed, the first error is the one to tell.
        with contextlib.suppress(OSError):
            temporary.unlink()
        raise InputError(
            f"{path}: cannot be written: {cause.strerror}. Name another place with --out."
        ) from None
