"""What waits for data of a DDS reader: subscriptions, service servers, clients."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

from jfto_dds.messages.decoder import MalformedPayloadError
from jfto_dds.wire.entities import Reader, Received, Writer

from ._rclpy_pybind11 import DESTROYED_TEXT
from .exceptions import InvalidHandle

_R = TypeVar("_R", bound="Receiver")


class Receiver:
    """A reader, its data ready or not, and for services the writer that belongs to it.

    A subclass says what a sample means to it in `_decode`, and what it is in `_words`.
    """

    def __init__(self, node: Any, callback_group: Any, qos_profile: Any) -> None:
        self._node = node
        self.callback_group = callback_group
        self.qos_profile = qos_profile
        self.event_handlers: list[Any] = []
        self._reader: Reader | None = None
        self._writer: Writer | None = None
        self._has_data = False
        self._destroyed = False
        self._malformed_count = 0

    def _decode(self, sample: Received) -> Callable[[], Any] | None:
        """What is to be called for a sample; None where it is for others.

        Raises MalformedPayloadError.
        """
        raise NotImplementedError

    def _words(self) -> tuple[str, str]:
        """What it receives, and where, for the log."""
        raise NotImplementedError

    @property
    def handle(self: _R) -> _R:
        """Stands for the handle of rcl."""
        return self

    def _require_alive(self) -> None:
        if self._destroyed:
            raise InvalidHandle(DESTROYED_TEXT)

    def _require_reader(self) -> Reader:
        if self._destroyed or self._reader is None:
            raise InvalidHandle(DESTROYED_TEXT)
        return self._reader

    def _on_data(self) -> None:
        # Called in a DDS thread.
        self._has_data = True
        self._node._wake_executor()

    def _is_ready(self) -> bool:
        return self._has_data

    def _take(self) -> Callable[[], Any] | None:
        """The next callback; samples that are malformed or not for us are passed over."""
        reader = self._reader
        if reader is None or self._destroyed:
            return None
        while True:
            self._has_data = False
            samples = reader.take()
            if not samples:
                return None
            self._has_data = True
            try:
                callback = self._decode(samples[0])
            except MalformedPayloadError as error:
                self._count_malformed(error)
                continue
            if callback is not None:
                return callback

    def _count_malformed(self, error: MalformedPayloadError) -> None:
        self._malformed_count += 1
        what, where = self._words()
        self._node.get_logger().warning(
            f"Dropped malformed {what} {self._malformed_count} {where}: {error}",
            throttle_duration_sec=1.0,
        )

    def destroy(self) -> None:
        """Leave the network; the node's destroy methods do this."""
        if self._destroyed:
            return
        self._destroyed = True
        self._has_data = False
        for handler in self.event_handlers:
            handler.destroy()
        for endpoint in (self._reader, self._writer):
            if endpoint is not None:
                self._node._remove_endpoint(endpoint)

    def __enter__(self: _R) -> _R:
        return self

    def __exit__(self, *_exception: object) -> None:
        self.destroy()
