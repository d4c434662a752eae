"""Severities of log messages."""

from __future__ import annotations

import enum


class LoggingSeverity(enum.IntEnum):
    """Severities as rcutils numbers them."""

    UNSET = 0
    DEBUG = 10
    INFO = 20
    WARN = 30
    ERROR = 40
    FATAL = 50
