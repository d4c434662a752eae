"""One supervised process: its command, its log, how it ended."""

from __future__ import annotations

import os
import signal
import subprocess
import threading
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from jfto.supervision.die_with_parent import SUPERVISOR

# A node ends within 2 s of being asked. One that is killed while it ends counts as unclean, so on a
# busy computer it gets more.
PATIENCE_S = 5.0


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
