"""Base of things other than topics, services and timers that an executor waits for."""

from __future__ import annotations

from typing import Any


class Waitable:
    """Something that becomes ready; only rclpy's own kinds exist here."""

    def __init__(self, callback_group: Any) -> None:
        self.callback_group = callback_group
        callback_group.add_entity(self)

    def _is_ready(self) -> bool:
        raise NotImplementedError

    def _take(self) -> Any:
        raise NotImplementedError
