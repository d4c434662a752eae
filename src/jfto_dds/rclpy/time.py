"""Points in time of one clock type, kept in integer nanoseconds."""

from __future__ import annotations

from typing import Any

from builtin_interfaces.msg import Time as TimeMsg

from .clock_type import ClockType
from .constants import S_TO_NS
from .duration import Duration

_LIMIT = 2**63


class Time:
    """A point in time; times of different clock types do not compare."""

    __hash__ = None  # type: ignore[assignment]

    def __init__(
        self,
        *,
        seconds: float = 0,
        nanoseconds: int = 0,
        clock_type: ClockType = ClockType.SYSTEM_TIME,
    ) -> None:
        if not isinstance(clock_type, ClockType):
            msg = "Clock type must be a ClockType enum"
            raise TypeError(msg)
        if seconds < 0:
            msg = "Seconds value must not be negative"
            raise ValueError(msg)
        if nanoseconds < 0:
            msg = "Nanoseconds value must not be negative"
            raise ValueError(msg)
        total = int(seconds * S_TO_NS) + int(nanoseconds)
        if total >= _LIMIT:
            msg = "Total nanoseconds value is too large to store in C time point."
            raise OverflowError(msg)
        self._nanoseconds = total
        self._clock_type = clock_type

    @property
    def nanoseconds(self) -> int:
        """Nanoseconds since the clock's epoch."""
        return self._nanoseconds

    def seconds_nanoseconds(self) -> tuple[int, int]:
        """Whole seconds, and the nanoseconds on top."""
        return divmod(self._nanoseconds, S_TO_NS)

    @property
    def clock_type(self) -> ClockType:
        """The kind of clock that this is a reading of."""
        return self._clock_type

    def __repr__(self) -> str:
        return f"Time(nanoseconds={self._nanoseconds}, clock_type={self._clock_type.name})"

    def __add__(self, other: object) -> Time:
        if not isinstance(other, Duration):
            return NotImplemented
        total = self._nanoseconds + other.nanoseconds
        if total >= _LIMIT:
            msg = "Addition leads to overflow in C storage."
            raise OverflowError(msg)
        if total < 0:
            msg = "Addition leads to negative time."
            raise ValueError(msg)
        return Time(nanoseconds=total, clock_type=self._clock_type)

    __radd__ = __add__

    def __sub__(self, other: object) -> Any:
        if isinstance(other, Time):
            if self._clock_type != other._clock_type:
                msg = "Can't subtract times with different clock types"
                raise TypeError(msg)
            return Duration(nanoseconds=self._nanoseconds - other._nanoseconds)
        if isinstance(other, Duration):
            total = self._nanoseconds - other.nanoseconds
            if total < 0:
                msg = "Subtraction leads to negative time."
                raise ValueError(msg)
            return Time(nanoseconds=total, clock_type=self._clock_type)
        return NotImplemented

    def _other(self, other: object) -> int | None:
        if not isinstance(other, Time):
            return None
        if self._clock_type != other._clock_type:
            msg = "Can't compare times with different clock types"
            raise TypeError(msg)
        return other._nanoseconds

    def __eq__(self, other: object) -> bool:
        value = self._other(other)
        return NotImplemented if value is None else self._nanoseconds == value

    def __lt__(self, other: object) -> bool:
        value = self._other(other)
        return NotImplemented if value is None else self._nanoseconds < value

    def __le__(self, other: object) -> bool:
        value = self._other(other)
        return NotImplemented if value is None else self._nanoseconds <= value

    def __gt__(self, other: object) -> bool:
        value = self._other(other)
        return NotImplemented if value is None else self._nanoseconds > value

    def __ge__(self, other: object) -> bool:
        value = self._other(other)
        return NotImplemented if value is None else self._nanoseconds >= value

    def to_msg(self) -> Any:
        """Convert to ``builtin_interfaces/Time``."""
        seconds, nanoseconds = self.seconds_nanoseconds()
        return TimeMsg(sec=seconds, nanosec=nanoseconds)

    @classmethod
    def from_msg(cls, msg: Any, clock_type: ClockType = ClockType.ROS_TIME) -> Time:
        """Convert from ``builtin_interfaces/Time``."""
        if not isinstance(msg, TimeMsg):
            text = "Must pass a builtin_interfaces.msg.Time object"
            raise TypeError(text)
        return cls(seconds=msg.sec, nanoseconds=msg.nanosec, clock_type=clock_type)
