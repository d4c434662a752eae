"""Service servers."""

from __future__ import annotations

import inspect
import struct
import threading
from collections.abc import Callable
from typing import Any

from cyclonedds.core import DDSException

from jfto_dds.messages.decoder import MalformedPayloadError
from jfto_dds.wire.entities import EntityClosedError, Reader, Received, Writer

from ._rclpy_pybind11 import DESTROYED_TEXT, RCLError
from .exceptions import InvalidHandle

HEADER = struct.Struct("<Qq")
BODY_START = 4 + HEADER.size
# How long a reply waits for the requester's reader, as in rmw_cyclonedds.
_MATCH_TIMEOUT_S = 0.1


def read_header(payload: bytes) -> tuple[int, int]:
    """Read the guid and sequence number that rmw puts in front of requests and replies.

    Raises
    ------
    MalformedPayloadError
        The payload is too short for them.
    """
    if len(payload) < BODY_START:
        msg = f"{len(payload)} bytes are too few for a service header"
        raise MalformedPayloadError(msg)
    order = "<" if payload[1] else ">"
    guid, sequence = struct.unpack_from(order + "Qq", payload, 4)
    return guid, sequence


class Service:
    """Answers requests."""

    def __init__(
        self,
        node: Any,
        srv_type: Any,
        srv_name: str,
        service_name: str,
        callback: Callable[[Any, Any], Any],
        callback_group: Any,
        qos_profile: Any,
    ) -> None:
        self._node = node
        self.srv_type = srv_type
        self.srv_name = srv_name
        self._service_name = service_name
        self.callback = callback
        self.callback_group = callback_group
        self.qos_profile = qos_profile
        self._request = srv_type.Request._TYPE_SUPPORT
        self._response = srv_type.Response._TYPE_SUPPORT
        self._reader: Reader | None = None
        self._writer: Writer | None = None
        self._has_data = False
        self._destroyed = False
        self._malformed_count = 0
        self._matched = threading.Condition(threading.Lock())
        self._known_clients: set[str] = set()

    @property
    def handle(self) -> Service:
        """Stands for rcl's service."""
        return self

    @property
    def service_name(self) -> str:
        """The fully qualified name."""
        if self._destroyed:
            raise InvalidHandle(DESTROYED_TEXT)
        return self._service_name

    def _on_data(self) -> None:
        # Called in a DDS thread.
        self._has_data = True
        self._node._wake_executor()

    def _on_matched(self, _writer: Any, _status: Any) -> None:
        # Called in a DDS thread.
        with self._matched:
            self._matched.notify_all()

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
            try:
                header = read_header(samples[0].payload)
                request = self._request.deserialize(samples[0].payload, BODY_START)
            except MalformedPayloadError as error:
                self._count_malformed(error)
                continue
            return lambda: self._answer(samples[0], header, request)

    def _count_malformed(self, error: MalformedPayloadError) -> None:
        self._malformed_count += 1
        self._node.get_logger().warning(
            f"Dropped malformed request {self._malformed_count} of service "
            f"'{self._service_name}': {error}",
            throttle_duration_sec=1.0,
        )

    def _answer(self, sample: Received, header: tuple[int, int], request: Any) -> Any:
        response = self.callback(request, self.srv_type.Response())
        if inspect.iscoroutine(response):
            return self._answer_later(sample, header, response)
        self._reply(sample, header, response)
        return None

    async def _answer_later(self, sample: Received, header: tuple[int, int], pending: Any) -> None:
        self._reply(sample, header, await pending)

    def _reply(self, sample: Received, header: tuple[int, int], response: Any) -> None:
        if not isinstance(response, self.srv_type.Response):
            raise TypeError
        writer, reader = self._writer, self._reader
        if self._destroyed or writer is None or reader is None:
            return
        if not self._node.context.ok():
            msg = "failed to send response: the context is invalid"
            raise RCLError(msg)
        try:
            if not self._await_client(reader, writer, sample.publication_handle):
                self._node.get_logger().warning(
                    f"failed to send response of service '{self._service_name}' (timeout): "
                    "client will not receive response"
                )
                return
            writer.write(self._response.serialize(response, HEADER.pack(*header)))
        except EntityClosedError:
            # Destroyed while it answered: nobody is left to tell.
            return
        except DDSException as error:
            msg = f"failed to send response: {error}"
            raise RCLError(msg) from error

    def _await_client(self, reader: Reader, writer: Writer, handle: int) -> bool:
        """Wait until the requester's reader is matched; without that the reply would be lost."""
        requester = reader.publication_user_data(handle)
        if requester is None:
            # The requester has left meanwhile.
            return False
        client = requester.get("clientid")
        if client is None or client in self._known_clients:
            return True

        def is_matched() -> bool:
            return any(data.get("clientid") == client for data in writer.matched().values())

        with self._matched:
            found = is_matched() or self._matched.wait_for(is_matched, _MATCH_TIMEOUT_S)
        if found:
            self._known_clients.add(client)
        return found

    def send_response(self, response: Any, header: Any) -> None:
        """Answer outside of the callback, which is not supported."""
        msg = "jfto_dds does not support Service.send_response: return the response instead"
        raise NotImplementedError(msg)

    def configure_introspection(self, *_args: Any) -> None:
        """Publish service events, which is not supported."""
        msg = "jfto_dds does not support service introspection"
        raise NotImplementedError(msg)

    def destroy(self) -> None:
        """Leave the service; :meth:`Node.destroy_service` does this."""
        if not self._destroyed:
            self._destroyed = True
            self._has_data = False
            for endpoint in (self._reader, self._writer):
                if endpoint is not None:
                    self._node._remove_endpoint(endpoint)

    def __enter__(self) -> Service:
        return self

    def __exit__(self, *_exception: object) -> None:
        self.destroy()
