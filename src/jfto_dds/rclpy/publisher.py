"""Publishers."""

from __future__ import annotations

from typing import Any

from cyclonedds.core import DDSException

from jfto_dds.wire.entities import EntityClosedError, Writer

from ._rclpy_pybind11 import DESTROYED_TEXT, RCLError
from .duration import Duration
from .exceptions import InvalidHandle


class Publisher:
    """Sends messages of one type on one topic."""

    def __init__(
        self,
        node: Any,
        msg_type: Any,
        topic: str,
        topic_name: str,
        qos_profile: Any,
        writer: Writer,
        event_handlers: list[Any],
    ) -> None:
        self._node = node
        self._context = node.context
        self.msg_type = msg_type
        self.topic = topic
        self._topic_name = topic_name
        self.qos_profile = qos_profile
        self._writer = writer
        self._serialize = msg_type._TYPE_SUPPORT.serialize
        self.event_handlers = event_handlers
        self._destroyed = False

    def _require(self) -> Writer:
        if self._destroyed:
            raise InvalidHandle(DESTROYED_TEXT)
        return self._writer

    @property
    def handle(self) -> Publisher:
        """Stands for rcl's publisher."""
        return self

    @property
    def topic_name(self) -> str:
        """The fully qualified topic."""
        self._require()
        return self._topic_name

    def publish(self, msg: Any) -> None:
        """Send a message, or bytes that are one already.

        Raises
        ------
        TypeError
            The message is of another type.
        RCLError
            The context is shut down, or DDS refuses.
        """
        writer = self._require()
        if isinstance(msg, self.msg_type):
            payload = self._serialize(msg)
        elif isinstance(msg, bytes):
            payload = msg
        else:
            text = f"Expected {self.msg_type}, got {type(msg)}"
            raise TypeError(text)
        if not self._context.ok():
            text = "Failed to publish: publisher's context is invalid"
            raise RCLError(text)
        try:
            writer.write(payload)
        except (DDSException, EntityClosedError) as error:
            text = f"Failed to publish: {error}"
            raise RCLError(text) from error

    def get_subscription_count(self) -> int:
        """Count the subscriptions that match."""
        return self._require().matched_count()

    def assert_liveliness(self) -> None:
        """Say that the publisher is alive, for manual liveliness."""
        self._require().assert_liveliness()

    def wait_for_all_acked(self, timeout: Duration = Duration(seconds=-1)) -> bool:  # noqa: B008
        """Wait until all reliable subscriptions have everything; False on time-out."""
        nanoseconds = timeout.nanoseconds
        return self._require().wait_for_acknowledgments(None if nanoseconds < 0 else nanoseconds)

    def destroy(self) -> None:
        """Leave the topic; :meth:`Node.destroy_publisher` does this."""
        if not self._destroyed:
            self._destroyed = True
            for handler in self.event_handlers:
                handler.destroy()
            self._node._remove_endpoint(self._writer)

    def __enter__(self) -> Publisher:
        return self

    def __exit__(self, *_exception: object) -> None:
        self.destroy()
