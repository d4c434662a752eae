"""Services that read and set logger levels of a node."""

from __future__ import annotations

from typing import Any

from rcl_interfaces.msg import LoggerLevel, SetLoggerLevelsResult
from rcl_interfaces.srv import GetLoggerLevels, SetLoggerLevels

from .logging import get_logger_level, set_logger_level


class LoggingService:
    """Lets other nodes see and change logger levels."""

    def __init__(self, node: Any) -> None:
        name = node.get_name()
        node.create_service(GetLoggerLevels, f"{name}/get_logger_levels", self._get)
        node.create_service(SetLoggerLevels, f"{name}/set_logger_levels", self._set)

    def _get(self, request: Any, response: Any) -> Any:
        response.levels = [
            LoggerLevel(name=name, level=int(get_logger_level(name))) for name in request.names
        ]
        return response

    def _set(self, request: Any, response: Any) -> Any:
        results = []
        for wanted in request.levels:
            try:
                set_logger_level(wanted.name, wanted.level)
                results.append(SetLoggerLevelsResult(successful=True))
            except ValueError as error:
                results.append(SetLoggerLevelsResult(successful=False, reason=str(error)))
        response.results = results
        return response
