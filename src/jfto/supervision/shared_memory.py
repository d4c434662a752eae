"""What killed nodes leave in shared memory, told from what others use, and taken away.

Fast DDS has a segment for each participant and one for each port on which it listens, 650 kB
together, in /dev/shm. Beside each lies a lock file that its participant keeps locked (flock) for as
long as it lives. Participants that end tidy up behind them; what a killed one had stays until the
computer is started anew. Names do not tell whose they are, but the kernel lists who holds a lock.
"""

from __future__ import annotations

import fcntl
import os
import re
from collections import defaultdict
from collections.abc import Collection
from pathlib import Path

FOLDER = Path("/dev/shm")  # noqa: S108  where the kernel has it
LOCKS = Path("/proc/locks")
_LOCK_FILE = re.compile(r"^(fast(?:rtps|dds)_(?:[0-9a-f]+|port\d+))_[es]l$")
# Number, kind, how, for what, process, device, file.
_LOCK = re.compile(r"^\d+: FLOCK +\w+ +\w+ +(\d+) ([0-9a-f]+):([0-9a-f]+):(\d+) ", re.MULTILINE)


class SharedMemory:
    """Remembers the lock files of processes while they live; knows none where there is no /proc."""

    def __init__(self) -> None:
        self._held: defaultdict[int, set[str]] = defaultdict(set)
        # Process and file number of each lock that was seen, so that names are looked up once.
        self._seen: set[tuple[int, int]] = set()
        self._untidy = False

    def look(self, pids: Collection[int]) -> None:
        """Take note of what these processes hold now; cheap enough for twice a second."""
        fresh = _locks(pids) - self._seen
        if not fresh:
            return
        self._seen |= fresh
        names = _lock_files()
        for pid, number in fresh:
            if number in names:
                self._held[pid].add(names[number])

    def clear(self, pid: int, *, killed: bool) -> list[str]:
        """Remove what a dead process has left, if it did not tidy up; returns lock files' names."""
        names = self._held.get(pid, set())
        # Where it did, its segment is gone; a port may stay until the last who sends there ends.
        if not killed and not any("port" not in name and _is_there(name) for name in names):
            return []
        self._untidy = True
        self._held.pop(pid, None)
        return sorted(name for name in names if _remove(name))

    def clear_ports(self) -> None:
        """Remove ports that tidy ones left because a killed one sent there; all must be dead."""
        if self._untidy:
            for names in self._held.values():
                for name in names:
                    _remove(name)


def _locks(pids: Collection[int]) -> set[tuple[int, int]]:
    """Process and file number of each lock in /dev/shm that one of these processes holds."""
    try:
        text, device = LOCKS.read_text(encoding="ascii"), FOLDER.stat().st_dev
    except OSError:
        return set()
    return {
        (int(pid), int(number))
        for pid, major, minor, number in _LOCK.findall(text)
        if int(pid) in pids and os.makedev(int(major, 16), int(minor, 16)) == device
    }


def _lock_files() -> dict[int, str]:
    """Names of Fast DDS's lock files by their numbers."""
    with os.scandir(FOLDER) as entries:
        return {each.inode(): each.name for each in entries if _LOCK_FILE.match(each.name)}


def _is_there(name: str) -> bool:
    return (FOLDER / name).exists()


def _remove(lock_name: str) -> bool:
    """Remove a lock file and what it stands for, unless somebody holds it by now."""
    match = _LOCK_FILE.match(lock_name)
    assert match is not None
    # The lock goes last: while it is held nobody takes the name.
    names = [match[1], f"sem.{match[1]}_mutex", lock_name]
    left = [FOLDER / name for name in names if _is_there(name)]
    try:
        with (FOLDER / lock_name).open("rb") as lock:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            for path in left:
                path.unlink()
    except FileNotFoundError:
        # Its owner gave the lock back, and only what a killed one had open too is still there.
        for path in left:
            path.unlink(missing_ok=True)
    except OSError:
        return False
    return bool(left)
