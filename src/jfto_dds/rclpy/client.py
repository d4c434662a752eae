"""Service clients."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Any

from cyclonedds.core import DDSException

from jfto_dds.messages.decoder import MalformedPayloadError
from jfto_dds.wire.entities import EntityClosedError, Reader, Writer

from ._rclpy_pybind11 import DESTROYED_TEXT, RCLError
from ._wake_up import WakeUp
from .exceptions import InvalidHandle
from .service import BODY_START, HEADER, read_header
from .task import Future

_GUID_MASK = 2**64 - 1


class Client:
    """Calls a service."""

    def __init__(
        self,
        node: Any,
        srv_type: Any,
        srv_name: str,
        service_name: str,
        callback_group: Any,
        qos_profile: Any,
    ) -> None:
        self._node = node
        self.context = node.context
        self.srv_type = srv_type
        self.srv_name = srv_name
        self._service_name = service_name
        self.callback_group = callback_group
        self.qos_profile = qos_profile
        self._request = srv_type.Request._TYPE_SUPPORT
        self._response = srv_type.Response._TYPE_SUPPORT
        self._reader: Reader | None = None
        self._writer: Writer | None = None
        self._guid = 0
        self._sequence = 0
        self._pending_requests: dict[int, Future] = {}
        self._lock = threading.RLock()
        self._has_data = False
        self._destroyed = False
        self._malformed_count = 0

    def _attach(self, reader: Reader, writer: Writer) -> None:
        self._reader, self._writer = reader, writer
        self._guid = writer.instance_handle & _GUID_MASK

    def _require(self) -> tuple[Reader, Writer]:
        if self._destroyed or self._reader is None or self._writer is None:
            raise InvalidHandle(DESTROYED_TEXT)
        return self._reader, self._writer

    @property
    def handle(self) -> Client:
        """Stands for rcl's client."""
        return self

    @property
    def service_name(self) -> str:
        """The fully qualified name."""
        self._require()
        return self._service_name

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
            payload = samples[0].payload
            try:
                guid, sequence = read_header(payload)
                if guid != self._guid:
                    # Somebody else's answer: all clients of a service see all replies.
                    continue
                response = self._response.deserialize(payload, BODY_START)
            except MalformedPayloadError as error:
                self._count_malformed(error)
                continue
            return lambda: self._complete(sequence, response)

    def _count_malformed(self, error: MalformedPayloadError) -> None:
        self._malformed_count += 1
        self._node.get_logger().warning(
            f"Dropped malformed reply {self._malformed_count} of service "
            f"'{self._service_name}': {error}",
            throttle_duration_sec=1.0,
        )

    def _complete(self, sequence: int, response: Any) -> None:
        with self._lock:
            future = self._pending_requests.get(sequence)
        if future is not None:
            future._set_executor(self._node.executor)
            future.set_result(response)

    def call_async(self, request: Any) -> Future:
        """Send a request; the future gets the response.

        Raises
        ------
        TypeError
            The request is of another type.
        RCLError
            The context is shut down, or DDS refuses.
        """
        if not isinstance(request, self.srv_type.Request):
            raise TypeError
        _, writer = self._require()
        if not self.context.ok():
            msg = "failed to send request: the context is invalid"
            raise RCLError(msg)
        future = Future()
        with self._lock:
            self._sequence += 1
            sequence = self._sequence
            self._pending_requests[sequence] = future
        future.add_done_callback(self.remove_pending_request)
        try:
            writer.write(self._request.serialize(request, HEADER.pack(self._guid, sequence)))
        except (DDSException, EntityClosedError) as error:
            self.remove_pending_request(future)
            msg = f"failed to send request: {error}"
            raise RCLError(msg) from error
        return future

    def call(self, request: Any, timeout_sec: float | None = None) -> Any:
        """Send a request and wait for the response; None on time-out.

        Some other thread must spin the node: called from a callback it needs a multi-threaded
        executor and a reentrant group.
        """
        if not isinstance(request, self.srv_type.Request):
            raise TypeError
        wake = WakeUp()
        future = self.call_async(request)
        future.add_done_callback(lambda _future: wake.set())
        self.context.on_shutdown(wake.set)
        try:
            if self.context.ok():
                wake.wait(timeout_sec)
        finally:
            self.context._forget(wake.set)
        if not future.done():
            self.remove_pending_request(future)
            return None
        return future.result()

    def get_pending_request(self, sequence_number: int) -> Future:
        """Look a waiting request up; raises KeyError."""
        with self._lock:
            return self._pending_requests[sequence_number]

    def remove_pending_request(self, future: Future) -> None:
        """Forget a request; its response will be dropped."""
        with self._lock:
            for sequence, pending in tuple(self._pending_requests.items()):
                if pending is future:
                    del self._pending_requests[sequence]

    def _ids(self, endpoint: Reader | Writer) -> set[str | None]:
        return {data.get("serviceid") for data in endpoint.matched().values()}

    def service_is_ready(self) -> bool:
        """Whether some server is matched in both directions."""
        reader, writer = self._require()
        if not reader.matched_count() or not writer.matched_count():
            return False
        replying = self._ids(reader)
        return any(server in replying for server in self._ids(writer))

    def wait_for_service(self, timeout_sec: float | None = None) -> bool:
        """Wait for a server; False on time-out or shutdown."""

        def settled() -> bool:
            return not self.context.ok() or self.service_is_ready()

        graph = self._node._participant.graph
        graph.wait_until(settled, None if timeout_sec is None else max(0.0, timeout_sec))
        return self.context.ok() and self.service_is_ready()

    def configure_introspection(self, *_args: Any) -> None:
        """Publish service events, which is not supported."""
        msg = "jfto_dds does not support service introspection"
        raise NotImplementedError(msg)

    def destroy(self) -> None:
        """Leave the service; :meth:`Node.destroy_client` does this."""
        if not self._destroyed:
            self._destroyed = True
            self._has_data = False
            for endpoint in (self._reader, self._writer):
                if endpoint is not None:
                    self._node._remove_endpoint(endpoint)

    def __enter__(self) -> Client:
        return self

    def __exit__(self, *_exception: object) -> None:
        self.destroy()
