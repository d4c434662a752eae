"""Subscriptions."""

from __future__ import annotations

import enum
import inspect
import time
from collections.abc import Callable
from typing import Any

from jfto_dds.messages.decoder import MalformedPayloadError
from jfto_dds.wire.entities import Reader

from ._rclpy_pybind11 import DESTROYED_TEXT
from .exceptions import InvalidHandle


class Subscription:
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
        self._node = node
        self.msg_type = msg_type
        self.topic = topic
        self._topic_name = topic_name
        self._with_info = False
        self.callback = callback
        self.callback_group = callback_group
        self.qos_profile = qos_profile
        self.raw = raw
        self.event_handlers: list[Any] = []
        self._deserialize = msg_type._TYPE_SUPPORT.deserialize
        self._reader: Reader | None = None
        self._has_data = False
        self._destroyed = False
        self._malformed_count = 0

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

    def _require(self) -> Reader:
        if self._destroyed or self._reader is None:
            raise InvalidHandle(DESTROYED_TEXT)
        return self._reader

    @property
    def handle(self) -> Subscription:
        """Stands for rcl's subscription."""
        return self

    @property
    def topic_name(self) -> str:
        """The fully qualified topic."""
        self._require()
        return self._topic_name

    def get_publisher_count(self) -> int:
        """Count the publishers that match."""
        return self._require().matched_count()

    def _on_data(self) -> None:
        # Called in a DDS thread.
        self._has_data = True
        self._node._wake_executor()

    def _is_ready(self) -> bool:
        return self._has_data

    def _take(self) -> Callable[[], Any] | None:
        reader = self._reader
        if reader is None or self._destroyed:
            return None
        while True:
            self._has_data = False
            samples = reader.take()
            if not samples:
                return None
            self._has_data = True
            sample = samples[0]
            if self.raw:
                message = sample.payload
                break
            try:
                message = self._deserialize(sample.payload)
                break
            except MalformedPayloadError as error:
                self._count_malformed(error)
        if not self._with_info:
            return lambda: self.callback(message)
        info = {
            "source_timestamp": sample.source_timestamp_ns,
            "received_timestamp": time.time_ns(),
            "publication_sequence_number": None,
            "reception_sequence_number": None,
        }
        return lambda: self.callback(message, info)

    def _count_malformed(self, error: MalformedPayloadError) -> None:
        self._malformed_count += 1
        self._node.get_logger().warning(
            f"Dropped malformed message {self._malformed_count} on topic "
            f"'{self._topic_name}' ({self.msg_type._TYPE_SUPPORT.full_name}): {error}",
            throttle_duration_sec=1.0,
        )

    def destroy(self) -> None:
        """Leave the topic; :meth:`Node.destroy_subscription` does this."""
        if not self._destroyed:
            self._destroyed = True
            self._has_data = False
            for handler in self.event_handlers:
                handler.destroy()
            if self._reader is not None:
                self._node._remove_endpoint(self._reader)

    def __enter__(self) -> Subscription:
        return self

    def __exit__(self, *_exception: object) -> None:
        self.destroy()


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
