"""Loggers with rcutils' filters: once, skip_first, throttle."""

from __future__ import annotations

import sys
from types import FrameType
from typing import Any, NamedTuple

from .._logging_backend import backend, short_file_name
from .logging_severity import LoggingSeverity

_FILTER_PARAMETERS = {
    "throttle": ("throttle_duration_sec", "throttle_time_source_type"),
    "skip_first": ("skip_first",),
    "once": ("once",),
}
_ALL_PARAMETERS = [name for names in _FILTER_PARAMETERS.values() for name in names]
_HERE = __file__


class CallerId(NamedTuple):
    """The place in the source that a filter's state belongs to."""

    function_name: str
    file_path: str
    line_number: int
    last_index: int


def _caller() -> CallerId:
    frame: FrameType | None = sys._getframe(1)
    while frame is not None and frame.f_code.co_filename == _HERE:
        frame = frame.f_back
    assert frame is not None
    return CallerId(frame.f_code.co_name, frame.f_code.co_filename, frame.f_lineno, frame.f_lasti)


def _requested_filters(options: dict[str, Any]) -> list[str]:
    for option in options:
        if option not in _ALL_PARAMETERS:
            msg = (
                f'parameter "{option}" is not one of the recognized logging options '
                f'"{_ALL_PARAMETERS}"'
            )
            raise TypeError(msg)
    requested = [
        name
        for name, parameters in _FILTER_PARAMETERS.items()
        if any(options.get(parameter) for parameter in parameters)
    ]
    if "throttle" in requested and options.get("throttle_duration_sec") is None:
        msg = (
            'required parameter "throttle_duration_sec" not specified but is required for the '
            'the logging filter "throttle"'
        )
        raise TypeError(msg)
    return requested


class _Site:
    """State of the filters of one line of source."""

    def __init__(self, name: str, severity: int, filters: list[str], options: dict) -> None:
        self.name = name
        self.severity = severity
        self.filters = filters
        self.options = dict(options)
        self._first_skipped = False
        self._logged_once = False
        self._last_ns = 0
        if "throttle" in filters:
            from ..clock import Clock

            self._clock = options.get("throttle_time_source_type") or Clock()
            if not isinstance(self._clock, Clock):
                msg = (
                    f'Received throttle_time_source_type of "{self._clock}" is not a clock instance'
                )
                raise ValueError(msg)

    def check_unchanged(self, name: str, severity: int, filters: list[str], options: dict) -> None:
        """Refuse other arguments on the same line, as rclpy does."""
        if severity != self.severity:
            msg = "Logger severity cannot be changed between calls."
            raise ValueError(msg)
        if name != self.name:
            msg = "Logger name cannot be changed between calls."
            raise ValueError(msg)
        if filters != self.filters:
            msg = "Requested logging filters cannot be changed between calls."
            raise ValueError(msg)
        if any(options.get(key) != self.options.get(key) for key in _ALL_PARAMETERS):
            msg = "Logging filter parameters cannot be changed between calls."
            raise ValueError(msg)

    def should_log(self) -> bool:
        """Ask the filters in their fixed order and update their state."""
        if "throttle" in self.filters:
            now_ns = self._clock.now().nanoseconds
            if now_ns < self._last_ns + self.options["throttle_duration_sec"] * 1e9:
                return False
            self._last_ns = now_ns
        if "skip_first" in self.filters and not self._first_skipped:
            self._first_skipped = True
            return False
        if "once" in self.filters:
            if self._logged_once:
                return False
            self._logged_once = True
        return True


class RcutilsLogger:
    """A named logger."""

    def __init__(self, name: str = "") -> None:
        self.name = name
        self.contexts: dict[CallerId, _Site] = {}

    def get_child(self, name: str) -> RcutilsLogger:
        """Make a logger below this one."""
        if not name:
            msg = "Child logger name must not be empty."
            raise ValueError(msg)
        return RcutilsLogger(f"{self.name}.{name}" if self.name else name)

    def set_level(self, level: int) -> None:
        """Set the least severity that is logged."""
        backend.set_level(self.name, LoggingSeverity(level))

    def get_effective_level(self) -> LoggingSeverity:
        """The level in force, own or inherited."""
        return LoggingSeverity(backend.effective_level(self.name))

    def is_enabled_for(self, severity: int) -> bool:
        """Whether a severity is logged."""
        return int(LoggingSeverity(severity)) >= backend.effective_level(self.name)

    def log(self, message: str, severity: int, **options: Any) -> bool:
        """Log a message; False where the level or a filter held it back."""
        if severity < backend.effective_level(self.name):
            return False
        severity = LoggingSeverity(severity)
        name = options.pop("name", self.name)
        if not isinstance(message, str):
            msg = (
                "rclpy_logging_rcutils_log(): incompatible function arguments. The following "
                "argument types are supported:\n    1. (arg0: int, arg1: str, arg2: str, "
                f"arg3: str, arg4: str, arg5: int) -> None\n\nInvoked with: {message!r}"
            )
            raise TypeError(msg)
        filters = _requested_filters(options)
        caller = _caller()
        site = self.contexts.get(caller)
        if site is None:
            site = self.contexts[caller] = _Site(name, severity, filters, options)
        else:
            site.check_unchanged(name, severity, filters, options)
        if not site.should_log():
            return False
        backend.log(
            severity,
            name,
            message,
            caller.function_name,
            short_file_name(caller.file_path),
            caller.line_number,
        )
        return True

    def debug(self, message: str, **kwargs: Any) -> bool:
        """Log with severity DEBUG."""
        return self.log(message, LoggingSeverity.DEBUG, **kwargs)

    def info(self, message: str, **kwargs: Any) -> bool:
        """Log with severity INFO."""
        return self.log(message, LoggingSeverity.INFO, **kwargs)

    def warning(self, message: str, **kwargs: Any) -> bool:
        """Log with severity WARN."""
        return self.log(message, LoggingSeverity.WARN, **kwargs)

    def warn(self, message: str, **kwargs: Any) -> bool:
        """Log with severity WARN."""
        return self.log(message, LoggingSeverity.WARN, **kwargs)

    def error(self, message: str, **kwargs: Any) -> bool:
        """Log with severity ERROR."""
        return self.log(message, LoggingSeverity.ERROR, **kwargs)

    def fatal(self, message: str, **kwargs: Any) -> bool:
        """Log with severity FATAL."""
        return self.log(message, LoggingSeverity.FATAL, **kwargs)
