"""Counts the operator's Ctrl-C, so that it is acted on between two looks and never inside one."""

from __future__ import annotations

import signal
from typing import Any

_SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)


class Interrupts:
    """Use as a context manager in the main thread; `take` says whether one has come since."""

    def __init__(self) -> None:
        self._count = 0
        self._previous: dict[int, Any] = {}

    def __enter__(self) -> Interrupts:
        for number in _SIGNALS:
            self._previous[number] = signal.signal(number, self._note)
        return self

    def __exit__(self, *_exception: object) -> None:
        for number, previous in self._previous.items():
            signal.signal(number, previous)

    @property
    def pending(self) -> bool:
        """Whether one has come that was not taken."""
        return self._count > 0

    def take(self) -> bool:
        """Whether the operator has interrupted since the last call, each time once."""
        if not self._count:
            return False
        self._count -= 1
        return True

    def _note(self, _number: int, _frame: Any) -> None:
        self._count += 1
