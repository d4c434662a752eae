"""Callbacks that the program triggers itself."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any


class GuardCondition:
    """Runs its callback once in the executor, however often it was triggered before."""

    def __init__(
        self, callback: Callable[[], Any] | None, callback_group: Any, wake: Callable[[], None]
    ) -> None:
        self.callback = callback
        self.callback_group = callback_group
        self._wake = wake
        self._triggered = False
        self._destroyed = False

    @property
    def handle(self) -> GuardCondition:
        """Stands for rcl's guard condition."""
        return self

    def trigger(self) -> None:
        """Ask for the callback."""
        self._triggered = True
        self._wake()

    def _is_ready(self) -> bool:
        return self._triggered and not self._destroyed

    def _take(self) -> Callable[[], Any] | None:
        if not self._triggered:
            return None
        self._triggered = False
        return self.callback

    def destroy(self) -> None:
        """Never call back again."""
        self._destroyed = True
