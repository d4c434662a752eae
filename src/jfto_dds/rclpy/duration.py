"""Spans of time, kept in integer nanoseconds."""

from __future__ import annotations

from typing import Any

from builtin_interfaces.msg import Duration as DurationMsg

from .constants import S_TO_NS

_LIMIT = 2**63


class Duration:
    """A span of time; no arithmetic in Jazzy, only comparison."""

    __hash__ = None  # type: ignore[assignment]

    def __init__(self, *, seconds: float = 0, nanoseconds: int = 0) -> None:
        if isinstance(seconds, str):
            # Multiplied, it would become a string of a gigabyte.
            msg = f"seconds is {seconds!r}, must be a number"
            raise TypeError(msg)
        total = int(seconds * S_TO_NS) + int(nanoseconds)
        if not -_LIMIT <= total < _LIMIT:
            msg = "Total nanoseconds value is too large to store in C duration."
            raise OverflowError(msg)
        self._nanoseconds = total

    @property
    def nanoseconds(self) -> int:
        """The whole span in nanoseconds."""
        return self._nanoseconds

    def __repr__(self) -> str:
        return f"Duration(nanoseconds={self._nanoseconds})"

    def __str__(self) -> str:
        if self._nanoseconds == _LIMIT - 1:
            return "Infinite"
        return f"{self._nanoseconds} nanoseconds"

    def __eq__(self, other: object) -> bool:
        if isinstance(other, Duration):
            return self._nanoseconds == other._nanoseconds
        return NotImplemented

    def __lt__(self, other: object) -> bool:
        if isinstance(other, Duration):
            return self._nanoseconds < other._nanoseconds
        return NotImplemented

    def __le__(self, other: object) -> bool:
        if isinstance(other, Duration):
            return self._nanoseconds <= other._nanoseconds
        return NotImplemented

    def __gt__(self, other: object) -> bool:
        if isinstance(other, Duration):
            return self._nanoseconds > other._nanoseconds
        return NotImplemented

    def __ge__(self, other: object) -> bool:
        if isinstance(other, Duration):
            return self._nanoseconds >= other._nanoseconds
        return NotImplemented

    def to_msg(self) -> Any:
        """Convert to ``builtin_interfaces/Duration``."""
        seconds, nanoseconds = divmod(self._nanoseconds, S_TO_NS)
        return DurationMsg(sec=seconds, nanosec=nanoseconds)

    @classmethod
    def from_msg(cls, msg: Any) -> Duration:
        """Convert from ``builtin_interfaces/Duration``."""
        if not isinstance(msg, DurationMsg):
            text = "Must pass a builtin_interfaces.msg.Duration object"
            raise TypeError(text)
        return cls(seconds=msg.sec, nanoseconds=msg.nanosec)


class Infinite:
    """Stands for a duration without end."""


INFINITE = Duration(nanoseconds=_LIMIT - 1)
