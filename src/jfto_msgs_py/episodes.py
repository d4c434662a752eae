"""Troubles that begin and end, each told once."""

from __future__ import annotations

from collections.abc import Collection, Hashable
from typing import Generic, TypeVar

Key = TypeVar("Key", bound=Hashable)


class Episodes(Generic[Key]):
    """Which troubles are on; one is over when it was absent `clear_after` times in a row."""

    def __init__(self, clear_after: int = 1) -> None:
        self._clear_after = clear_after
        self._absent: dict[Key, int] = {}

    def __contains__(self, key: Key) -> bool:
        return key in self._absent

    def update(self, present: Collection[Key]) -> tuple[list[Key], list[Key]]:
        """Take what is seen now; returns what has begun and what is over."""
        began = [key for key in present if key not in self._absent]
        over = []
        for key in tuple(self._absent):
            self._absent[key] = 0 if key in present else self._absent[key] + 1
            if self._absent[key] >= self._clear_after:
                del self._absent[key]
                over.append(key)
        self._absent.update(dict.fromkeys(began, 0))
        return began, over
