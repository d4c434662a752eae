"""What a node complains about, picked out of its log while it grows."""

from __future__ import annotations

from pathlib import Path

MARKS = ("[ERROR]", "[FATAL]")
# A log that grows faster than this between two looks is not read whole.
_CHUNK = 1 << 16


class LogTail:
    """New lines of a log that hold an error, each once; repeated texts are left out."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self._offset = path.stat().st_size if path.exists() else 0
        self._rest = b""
        self._last = ""

    def complaints(self) -> list[str]:
        """Texts of the errors that were logged since the last call."""
        if not self._path.exists():
            return []
        with self._path.open("rb") as log:
            log.seek(self._offset)
            data = log.read(_CHUNK)
        self._offset += len(data)
        *lines, self._rest = (self._rest + data).split(b"\n")
        found = []
        for line in lines:
            text = line.decode(errors="replace")
            if any(mark in text for mark in MARKS):
                said = text.partition("]: ")[2] or text
                if said != self._last:
                    found.append(said)
                self._last = said
        return found
