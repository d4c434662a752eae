"""Service servers."""

from __future__ import annotations

import inspect
import threading
from collections.abc import Callable
from typing import Any

from cyclonedds.core import DDSException

from jfto_dds.wire.entities import EntityClosedError, Reader, Received, Writer

from ._rclpy_pybind11 import RCLError
from ._service_side import BODY_START, HEADER, ServiceSide, read_header

# How long a reply waits for the requester's reader, as in rmw_cyclonedds.
_MATCH_TIMEOUT_S = 0.1


class Service(ServiceSide):
    """Answers requests."""

    _ROLE = "serviceid"

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
        super().__init__(node, srv_type, srv_name, service_name, callback_group, qos_profile)
        self.callback = callback
        self._matched = threading.Condition(threading.Lock())
        self._known_clients: set[str] = set()

    def _on_matched(self, _writer: Any, _status: Any) -> None:
        # Called in a DDS thread.
        with self._matched:
            self._matched.notify_all()

    def _words(self) -> tuple[str, str]:
        return "request", f"of service '{self._service_name}'"

    def _decode(self, sample: Received) -> Callable[[], Any]:
        header = read_header(sample.payload)
        request = self._request.deserialize(sample.payload, BODY_START)
        return lambda: self._answer(sample, header, request)

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
