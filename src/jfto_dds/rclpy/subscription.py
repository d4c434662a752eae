"""Subscriptions."""

from __future__ import annotations

import enum
import inspect
import time
from collections.abc import Callable
from typing import Any

from jfto_dds.wire.entities import Received

from ._receiver import Receiver


class Subscription(Receiver):
    """Calls back with each message of one topic."""

    class CallbackType(enum.Enum):
        """What the callback takes."""

        MessageOnly = 0
        WithMessageInfo = 1

    def __init__(
        self,
        node: Any,
        msg_type: Any,
        topic: str,
        topic_name: str,
        callback: Callable,
        callback_group: Any,
        qos_profile: Any,
        raw: bool,
    ) -> None:
        super().__init__(node, callback_group, qos_profile)
        self.msg_type = msg_type
        self.topic = topic
        self._topic_name = topic_name
        self._with_info = False
        self.callback = callback
        self.raw = raw
        self._deserialize = msg_type._TYPE_SUPPORT.deserialize

    @property
    def callback(self) -> Callable:
        """The callback; it takes the message, or the message and what is known about it."""
        return self._callback

    @callback.setter
    def callback(self, value: Callable) -> None:
        self._with_info = _wants_info(value)
        self._callback = value
        self._callback_type = (
            self.CallbackType.WithMessageInfo if self._with_info else self.CallbackType.MessageOnly
        )

    @property
    def topic_name(self) -> str:
        """The fully qualified topic."""
        self._require_alive()
        return self._topic_name

    def get_publisher_count(self) -> int:
        """Count the publishers that match."""
        return self._require_reader().matched_count()

    def _words(self) -> tuple[str, str]:
        return "message", f"on topic '{self._topic_name}' ({self.msg_type._TYPE_SUPPORT.full_name})"

    def _decode(self, sample: Received) -> Callable[[], Any]:
        message = sample.payload if self.raw else self._deserialize(sample.payload)
        if not self._with_info:
            return lambda: self.callback(message)
        info = {
            "source_timestamp": sample.source_timestamp_ns,
            "received_timestamp": time.time_ns(),
            "publication_sequence_number": None,
            "reception_sequence_number": None,
        }
        return lambda: self.callback(message, info)


def _accepts(signature: inspect.Signature, count: int) -> bool:
    try:
        signature.bind(*range(count))
    except TypeError:
        return False
    return True


def _wants_info(callback: Any) -> bool:
    if callable(callback):
        try:
            signature = inspect.signature(callback)
        except ValueError:
            # Builtins without a signature take the message only.
            return False
        if _accepts(signature, 1):
            return False
        if _accepts(signature, 2):
            return True
    msg = (
        "Subscription.__init__(): callback should be either be callable with one argument"
        "(to get only the message) or two (to get message and message info)"
    )
    raise RuntimeError(msg)
