"""Planning in a thread of its own, which can be called off."""

from __future__ import annotations

import threading
from collections.abc import Callable

from jfto_msgs_py.errors import JftoError
from jfto_msgs_py.records.plan import Plan

# Hears of progress, 0 to 1, with a note; raises to call the planning off.
Progress = Callable[[float, str], None]


class PlanningStoppedError(JftoError):
    """Planning was stopped before it was done."""


class PlanJob:
    """One planning: `done` is called in its thread when `result` or `error` is there."""

    def __init__(self, make: Callable[[Progress], Plan], done: Callable[[], None]) -> None:
        self.result: Plan | None = None
        self.error: JftoError | None = None
        self.share = 0.0
        self.note = ""
        self._make = make
        self._done = done
        self._called_off = threading.Event()
        self._thread = threading.Thread(target=self._run, name="planning", daemon=True)
        self._thread.start()

    def call_off(self, wait_s: float = 1.0) -> None:
        """Ask it to stop, and give it that long."""
        self._called_off.set()
        self._thread.join(wait_s)

    def _progress(self, share: float, note: str = "") -> None:
        self.share, self.note = share, note
        if self._called_off.is_set():
            raise PlanningStoppedError("Planning was called off.")

    def _run(self) -> None:
        try:
            self.result = self._make(self._progress)
        except JftoError as error:
            self.error = error
        except Exception as error:  # noqa: BLE001 - the executor's thread tells it
            self.error = JftoError(f"Planning failed: {type(error).__name__}: {error}")
        if not self._called_off.is_set():
            self._done()
