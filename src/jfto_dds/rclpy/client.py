"""Service clients."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Any

from cyclonedds.core import DDSException

from jfto_dds.wire.entities import EntityClosedError, Reader, Received, Writer

from ._rclpy_pybind11 import DESTROYED_TEXT, RCLError
from ._service_side import BODY_START, HEADER, ServiceSide, read_header
from ._wake_up import WakeUp
from .exceptions import InvalidHandle
from .task import Future

_GUID_MASK = 2**64 - 1


class Client(ServiceSide):
    """Calls a service."""

    _ROLE = "clientid"

    def __init__(
        self,
        node: Any,
        srv_type: Any,
        srv_name: str,
        service_name: str,
        callback_group: Any,
        qos_profile: Any,
    ) -> None:
        super().__init__(node, srv_type, srv_name, service_name, callback_group, qos_profile)
        self.context = node.context
        self._guid = 0
        self._sequence = 0
        self._pending_requests: dict[int, Future] = {}
        self._lock = threading.RLock()

    def _attach(self, reader: Reader, writer: Writer) -> None:
        super()._attach(reader, writer)
        self._guid = writer.instance_handle & _GUID_MASK

    def _require(self) -> tuple[Reader, Writer]:
        if self._destroyed or self._reader is None or self._writer is None:
            raise InvalidHandle(DESTROYED_TEXT)
        return self._reader, self._writer

    def _on_matched(self, _endpoint: Any, _status: Any) -> None:
        # Called in a DDS thread.
        self._node._participant.graph.notify()

    def _words(self) -> tuple[str, str]:
        return "reply", f"of service '{self._service_name}'"

    def _decode(self, sample: Received) -> Callable[[], Any] | None:
        guid, sequence = read_header(sample.payload)
        if guid != self._guid:
            # Somebody else's answer: all clients of a service see all replies.
            return None
        response = self._response.deserialize(sample.payload, BODY_START)
        return lambda: self._complete(sequence, response)

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
