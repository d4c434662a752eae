"""Loggers and their levels."""

from __future__ import annotations

from ._logging_backend import SEVERITY_BY_NAME, backend
from .impl.logging_severity import LoggingSeverity
from .impl.rcutils_logger import RcutilsLogger

__all__ = [
    "LoggingSeverity",
    "clear_config",
    "get_logger",
    "get_logger_effective_level",
    "get_logger_level",
    "get_logging_severity_from_string",
    "initialize",
    "set_logger_level",
    "shutdown",
]


def get_logger(name: str) -> RcutilsLogger:
    """Make a logger of this name."""
    if not name:
        msg = "Logger name must not be empty."
        raise ValueError(msg)
    return RcutilsLogger(name)


def initialize() -> None:
    """Nothing to prepare."""


def shutdown() -> None:
    """Nothing to give back."""


def clear_config() -> None:
    """Nothing to clear: there is no configuration file."""


def set_logger_level(name: str, level: int, *, detailed_error: bool = False) -> bool:
    """Set a logger's level; an unknown level raises ValueError."""
    del detailed_error
    backend.set_level(name, LoggingSeverity(level))
    return True


def get_logger_effective_level(name: str) -> LoggingSeverity:
    """The level in force for a logger."""
    return LoggingSeverity(backend.effective_level(name))


def get_logger_level(name: str) -> LoggingSeverity:
    """A logger's own level."""
    return LoggingSeverity(backend.level(name))


def get_logging_severity_from_string(log_severity: str) -> LoggingSeverity:
    """Look a severity up by its name in any case; raises RuntimeError."""
    severity = SEVERITY_BY_NAME.get(log_severity.lower())
    if severity is None:
        msg = "Failed to get severity name"
        raise RuntimeError(msg)
    return severity
