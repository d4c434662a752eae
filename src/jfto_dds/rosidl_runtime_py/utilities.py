"""Interface classes by their full names."""

from __future__ import annotations

import importlib
from typing import Any


def _import(text: str, kind: str) -> Any:
    parts = text.split("/")
    if len(parts) == 2:
        parts = [parts[0], kind, parts[1]]
    # A bare name gives an empty module name, which Python refuses with rclpy's words.
    module = importlib.import_module(".".join(parts[:-1]))
    return getattr(module, parts[-1])


def get_message(identifier: str) -> Any:
    """Import a message class, ``std_msgs/msg/String`` or ``std_msgs/String``."""
    return _import(identifier, "msg")


def get_service(identifier: str) -> Any:
    """Import a service class, ``std_srvs/srv/Trigger``."""
    return _import(identifier, "srv")


def get_interface(identifier: str) -> Any:
    """Import a message or service class by its full name."""
    return _import(identifier, "msg")
