"""Integer nanoseconds as builtin_interfaces Time and Duration."""

from __future__ import annotations

from typing import Any

from jfto_msgs_py.errors import MessageError


def encode_time(nanoseconds: int) -> Any:
    """builtin_interfaces/Time of nanoseconds since the epoch."""
    from builtin_interfaces.msg import Time

    seconds, rest = divmod(nanoseconds, 10**9)
    return Time(sec=seconds, nanosec=rest)


def decode_time(stamp: Any, field: str = "header.stamp") -> int:
    """Nanoseconds since the epoch. Raises MessageError for a stamp before 0 or with overflow."""
    if stamp.sec < 0 or stamp.nanosec >= 10**9:
        raise MessageError(field, f"is {stamp.sec} s {stamp.nanosec} ns, not a time")
    return int(stamp.sec) * 10**9 + int(stamp.nanosec)


def encode_duration(nanoseconds: int) -> Any:
    """builtin_interfaces/Duration of nanoseconds."""
    from builtin_interfaces.msg import Duration

    seconds, rest = divmod(nanoseconds, 10**9)
    return Duration(sec=seconds, nanosec=rest)


def decode_duration(duration: Any, field: str) -> int:
    """Nanoseconds of a builtin_interfaces/Duration."""
    if duration.nanosec >= 10**9:
        raise MessageError(field, f"has {duration.nanosec} ns, must be below 1e9")
    return int(duration.sec) * 10**9 + int(duration.nanosec)
