"""One supervised process: its command, its log, how it ended, when it is started again."""

from __future__ import annotations

import ctypes
import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from jfto_msgs_py.retry import Retry

# Tells a process who its supervisor is, by that one's number.
SUPERVISOR = "JFTO_SUPERVISOR"
_PR_SET_PDEATHSIG = 1
# A node ends within 2 s of being asked. One that is killed while it ends counts as unclean, so on a
# busy computer it gets more.
PATIENCE_S = 5.0
RESTARTS = Retry(first_s=0.1, ceiling_s=5.0, factor=2.0, tries=8)
# Who was up for so long is sound: what came before its death counts no more.
SOUND_AFTER_S = 3.0
# In a node's log, what it complains about.
_MARKS = ("[ERROR]", "[FATAL]")
# A log that grows faster than this between two looks is not read whole.
_CHUNK = 1 << 16


@dataclass(frozen=True)
class NodeCommand:
    """What runs a node: its name, which its log is named after, and its command line.

    One that has not ended `patience_s` after it was asked to is made to.
    """

    name: str
    command: Sequence[str]
    environment: Mapping[str, str]
    patience_s: float = PATIENCE_S


class Process:
    """A running command; `ended` is called from a thread of its own with the exit status.

    Its output is added to `log`. It has a session of its own, so that Ctrl-C in the terminal
    reaches it in the supervisor's order only; it is told who the supervisor is, so that it can end
    with it.
    """

    def __init__(self, node: NodeCommand, log: Path, ended: Callable[[int], None]) -> None:
        self.started_s = time.monotonic()
        self._patience_s = node.patience_s
        with log.open("ab") as output:
            self._process = subprocess.Popen(
                node.command,
                env={**node.environment, SUPERVISOR: str(os.getpid())},
                stdin=subprocess.DEVNULL,
                stdout=output,
                stderr=subprocess.STDOUT,
                start_new_session=True,
            )
        self._ended = ended
        self._watcher = threading.Thread(target=self._watch, name=f"watch {node.name}", daemon=True)
        self._watcher.start()

    @property
    def pid(self) -> int:
        """Number of the process."""
        return self._process.pid

    @property
    def uptime_s(self) -> float:
        """Seconds since it was started."""
        return time.monotonic() - self.started_s

    def stop(self) -> int:
        """End it by SIGINT, then SIGTERM, then SIGKILL, its patience apart; its exit status.

        A shell that starts a program in the background has it and its children ignore SIGINT, which
        is then left out.
        """
        heard = signal.getsignal(signal.SIGINT) is not signal.SIG_IGN
        for number in (signal.SIGINT, signal.SIGTERM) if heard else (signal.SIGTERM,):
            self._process.send_signal(number)
            try:
                return self._process.wait(self._patience_s)
            except subprocess.TimeoutExpired:
                continue
        self._process.kill()
        return self._process.wait()

    def _watch(self) -> None:
        self._ended(self._process.wait())


def ending(status: int) -> str:
    """An exit status in words."""
    if status < 0:
        return f"killed by {signal.Signals(-status).name}"
    return f"ended with status {status}"


def die_with_parent() -> None:
    """Ask the kernel for SIGTERM when the supervisor is gone; nothing where there is none.

    Only Linux can do this; elsewhere nodes of a killed supervisor have to be stopped by hand.
    """
    supervisor = os.environ.get(SUPERVISOR, "")
    if not supervisor or not sys.platform.startswith("linux"):
        return
    ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGTERM)
    if str(os.getppid()) != supervisor:
        # It died before the kernel was asked.
        sys.exit("The supervisor is gone.")


class BackOff:
    """Waits that grow with every death by a policy, until a process has been up long enough."""

    def __init__(self, retry: Retry) -> None:
        self._retry = retry
        self._deaths = 0

    def wait_s(self, uptime_s: float) -> float | None:
        """Wait after a death `uptime_s` after the start; None to give the process up."""
        self._deaths = 1 if uptime_s >= SOUND_AFTER_S else self._deaths + 1
        return self._retry.wait_s(self._deaths)


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
            if any(mark in text for mark in _MARKS):
                said = text.partition("]: ")[2] or text
                if said != self._last:
                    found.append(said)
                self._last = said
        return found
