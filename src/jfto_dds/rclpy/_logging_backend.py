"""Levels, console output and ``/rosout`` of all loggers, in the manner of rcutils."""

from __future__ import annotations

import os
import re
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path

from .impl.logging_severity import LoggingSeverity

SEVERITY_BY_NAME = {severity.name.lower(): severity for severity in LoggingSeverity}
_COLOURS = {
    LoggingSeverity.DEBUG: "\033[32m",
    LoggingSeverity.INFO: "\033[0m",
    LoggingSeverity.WARN: "\033[33m",
    LoggingSeverity.ERROR: "\033[31m",
    LoggingSeverity.FATAL: "\033[31m",
}
_RESET = "\033[0m"
_DEFAULT_FORMAT = "[{severity}] [{time}] [{name}]: {message}"
_TOKEN = re.compile(r"\{(\w+)\}")
_ESCAPES = {r"\a": "\a", r"\b": "\b", r"\n": "\n", r"\r": "\r", r"\t": "\t"}

# publish(stamp_ns, severity, logger name, text, file, function, line)
RosoutSink = Callable[[int, int, str, str, str, str, int], None]


class LoggingBackend:
    """State that all loggers of a process share."""

    def __init__(self) -> None:
        self._lock = threading.RLock()
        self._levels: dict[str, int] = {}
        self._default_level = int(LoggingSeverity.INFO)
        self._sinks: dict[str, RosoutSink] = {}
        self._console = True
        self._format: str | None = None

    def configure(self, levels: dict[str, int], *, console: bool) -> None:
        """Apply what a command line says; the level of the empty name is the default."""
        with self._lock:
            self._console = console
            self._format = None
            for name, level in levels.items():
                if name:
                    self._levels[name] = int(level)
                else:
                    self._default_level = int(level)

    def set_level(self, name: str, level: int) -> None:
        """Set a logger's own level; UNSET makes it follow its parent."""
        with self._lock:
            if name == "":
                self._default_level = int(level) or int(LoggingSeverity.INFO)
            else:
                self._levels[name] = int(level)

    def level(self, name: str) -> int:
        """A logger's own level, UNSET where it has none."""
        return self._levels.get(name, 0)

    def effective_level(self, name: str) -> int:
        """The level in force: a logger's own, its nearest ancestor's, or the default."""
        while name:
            level = self._levels.get(name, 0)
            if level:
                return level
            name = name.rpartition(".")[0]
        return self._default_level

    def add_sink(self, name: str, sink: RosoutSink) -> None:
        """Publish what logger ``name`` and its children log."""
        with self._lock:
            self._sinks[name] = sink

    def remove_sink(self, name: str) -> None:
        """Stop publishing what a logger logs."""
        with self._lock:
            self._sinks.pop(name, None)

    def log(
        self, severity: int, name: str, message: str, function: str, file: str, line: int
    ) -> None:
        """Write one message to the console and to ``/rosout``; the level was checked before."""
        stamp_ns = time.time_ns()
        if self._console:
            self._write(severity, name, message, function, file, line, stamp_ns)
        owner = name
        while owner:
            sink = self._sinks.get(owner)
            if sink is not None:
                sink(stamp_ns, severity, name, message, file, function, line)
                return
            owner = owner.rpartition(".")[0]

    def _write(
        self,
        severity: int,
        name: str,
        message: str,
        function: str,
        file: str,
        line: int,
        stamp_ns: int,
    ) -> None:
        if self._format is None:
            self._format = _output_format()
        seconds, nanoseconds = divmod(stamp_ns, 10**9)
        values = {
            "severity": LoggingSeverity(severity).name,
            "name": name,
            "message": message,
            "function_name": function,
            "file_name": file,
            "line_number": str(line),
            "time": f"{seconds:010d}.{nanoseconds:09d}",
            "time_as_nanoseconds": str(stamp_ns),
            "date_time_with_ms": _date_time(seconds, nanoseconds),
        }
        text = _TOKEN.sub(lambda token: values.get(token[1], token[0]), self._format)
        stream = sys.stdout if _flag("RCUTILS_LOGGING_USE_STDOUT") else sys.stderr
        if stream is None:
            return
        colour = os.environ.get("RCUTILS_COLORIZED_OUTPUT", "")
        if colour == "1" or (colour != "0" and stream.isatty()):
            text = f"{_COLOURS[LoggingSeverity(severity)]}{text}{_RESET}"
        stream.write(text + "\n")
        stream.flush()


def _flag(name: str) -> bool:
    return os.environ.get(name, "") == "1"


def _date_time(seconds: int, nanoseconds: int) -> str:
    return time.strftime("%Y-%m-%d %H:%M:%S", time.localtime(seconds)) + (
        f".{nanoseconds // 10**6:03d}"
    )


def _output_format() -> str:
    text = os.environ.get("RCUTILS_CONSOLE_OUTPUT_FORMAT", "") or _DEFAULT_FORMAT
    for escape, meaning in _ESCAPES.items():
        text = text.replace(escape, meaning)
    return text


def short_file_name(path: str) -> str:
    """The file as log records show it: its bare name."""
    return Path(path).name


backend = LoggingBackend()
