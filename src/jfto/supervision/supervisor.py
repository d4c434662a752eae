"""Starts processes, starts them again when they die, and stops all of them in order."""

from __future__ import annotations

import fcntl
import os
import queue
import time
from collections.abc import Callable, Collection, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path

from jfto.supervision.process import (
    RESTARTS,
    BackOff,
    LogTail,
    NodeCommand,
    Process,
    ending,
)
from jfto.supervision.shared_memory import SharedMemory
from jfto_msgs_py.errors import InputError
from jfto_msgs_py.files import write_json
from jfto_msgs_py.retry import Retry

# How often logs are looked at for errors.
_LOOK_S = 0.5
STATUS_NAME = "status.json"
LOGS = "logs"
LOCK_NAME = ".in-use"


@dataclass
class _Slot:
    """A node's place: its process while it runs, else when it is started again."""

    node: NodeCommand
    back_off: BackOff
    tail: LogTail
    process: Process | None = None
    again_at_s: float | None = None
    restarts: int = 0
    given_up: str = ""


@dataclass(frozen=True)
class Outcome:
    """How a graph ended: whether it was stopped from outside, and which nodes were given up."""

    stopped: bool
    failed: dict[str, str] = field(default_factory=dict)
    unclean: dict[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class Death:
    """A node's process has ended by itself: how, and in how long it is started again.

    `again_s` is None where it was given up.
    """

    name: str
    how: str
    again_s: float | None


class Supervisor:
    """Runs nodes until `stop` or until one is given up; `tell` hears what happens, in words.

    Of `essential` nodes, all where None, none may be given up; without another one the rest goes
    on. `died` hears of each death, in the thread of `run`.

    Each node's output goes to `directory`/logs/<name>.log; `directory`/status.json always holds
    the state of all.
    """

    def __init__(
        self,
        nodes: Sequence[NodeCommand],
        directory: Path,
        tell: Callable[[str, str], None],
        restarts: Retry = RESTARTS,
        essential: Collection[str] | None = None,
        died: Callable[[Death], None] = lambda _death: None,
    ) -> None:
        self._slots = [
            _Slot(node, BackOff(restarts), LogTail(directory / LOGS / f"{node.name}.log"))
            for node in nodes
        ]
        self._directory = directory
        self._tell, self._died, self._essential = tell, died, essential
        self._shared_memory = SharedMemory()
        self._events: queue.SimpleQueue[tuple[_Slot, Process, int] | None] = queue.SimpleQueue()

    def run(self) -> Outcome:
        """Start all in order and keep them up; returns when stopped, or when one is given up.

        Raises InputError where logs cannot be written, or another graph writes there.
        """
        try:
            (self._directory / LOGS).mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise InputError(
                f"{self._directory}: cannot be made: {error.strerror}. Name another with --out."
            ) from None
        stopped = False
        with held(self._directory):
            try:
                for slot in self._slots:
                    self._start(slot)
                self._write_status()
                stopped = self._watch()
            finally:
                unclean = self._stop_all()
        failed = {s.node.name: s.given_up for s in self._slots if s.given_up}
        return Outcome(stopped, failed, unclean)

    def stop(self) -> None:
        """Let `run` stop all and return; may be called from any thread or signal handler."""
        self._events.put(None)

    def _watch(self) -> bool:
        while True:
            try:
                event = self._events.get(timeout=self._next_look_s())
            except queue.Empty:
                self._look()
                continue
            if event is None:
                return True
            slot, process, status = event
            if slot.process is process and not self._mourn(slot, process, status):
                return False

    def _next_look_s(self) -> float:
        now_s = time.monotonic()
        waits = [slot.again_at_s - now_s for slot in self._slots if slot.again_at_s is not None]
        return max(min([_LOOK_S, *waits]), 0.0)

    def _look(self) -> None:
        """Start again whom it is time for, and pass on what nodes complain about."""
        for slot in self._slots:
            if slot.again_at_s is not None and slot.again_at_s <= time.monotonic():
                slot.restarts += 1
                self._start(slot)
                self._write_status()
            for complaint in slot.tail.complaints():
                self._tell(slot.node.name, f"⚠ {complaint}")
        self._shared_memory.look({slot.process.pid for slot in self._slots if slot.process})

    def _start(self, slot: _Slot) -> None:
        log = self._directory / LOGS / f"{slot.node.name}.log"
        slot.again_at_s = None
        slot.process = process = Process(
            slot.node, log, lambda status: self._events.put((slot, process, status))
        )
        word = "restarted" if slot.restarts else "started"
        self._tell(slot.node.name, f"{word}, pid {process.pid}")

    def _mourn(self, slot: _Slot, process: Process, status: int) -> bool:
        """Arrange for a dead process's restart; False where nothing goes on without it."""
        slot.process = None
        self._shared_memory.clear(process.pid, killed=status < 0)
        how = ending(status)
        # Status 2 says that its parameters are wrong: they will be wrong again.
        wait_s = (
            None if status == InputError.exit_status else slot.back_off.wait_s(process.uptime_s)
        )
        self._died(Death(slot.node.name, how, wait_s))
        if wait_s is None:
            slot.given_up = f"{how} after {process.uptime_s:.1f} s"
            self._tell(slot.node.name, f"{slot.given_up}, given up")
            self._write_status()
            return self._essential is not None and slot.node.name not in self._essential
        slot.again_at_s = time.monotonic() + wait_s
        self._tell(slot.node.name, f"{how} after {process.uptime_s:.1f} s, again in {wait_s:.1f} s")
        self._write_status()
        return True

    def _stop_all(self) -> dict[str, str]:
        """Stop in reverse order of starting; returns those that did not end cleanly."""
        unclean = {}
        for slot in reversed(self._slots):
            process, slot.process, slot.again_at_s = slot.process, None, None
            if process is None:
                continue
            status = process.stop()
            self._shared_memory.clear(process.pid, killed=status < 0)
            self._tell(slot.node.name, "stopped" if status == 0 else ending(status))
            if status != 0:
                unclean[slot.node.name] = ending(status)
        self._shared_memory.clear_ports()
        self._write_status()
        return unclean

    def _write_status(self) -> None:
        state = {
            slot.node.name: {
                "pid": slot.process.pid if slot.process else None,
                "restarts": slot.restarts,
                "given_up": slot.given_up,
            }
            for slot in self._slots
        }
        write_json(self._directory / STATUS_NAME, state)


@contextmanager
def held(directory: Path) -> Iterator[None]:
    """Keep other graphs out of a directory for as long as the context lasts; raises InputError.

    Its plan, energy account and logs are not for two. The kernel gives the directory free however
    the process ends.
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
