"""One side of a service: what servers and clients have in common."""

from __future__ import annotations

import struct
from typing import Any

from jfto_dds.messages.decoder import MalformedPayloadError
from jfto_dds.wire.entities import Reader, Writer

from ._receiver import Receiver

HEADER = struct.Struct("<Qq")
BODY_START = 4 + HEADER.size


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


class ServiceSide(Receiver):
    """A server or a client of a service. `_ROLE` is the key of its id in USER_DATA."""

    _ROLE = ""

    def __init__(
        self,
        node: Any,
        srv_type: Any,
        srv_name: str,
        service_name: str,
        callback_group: Any,
        qos_profile: Any,
    ) -> None:
        super().__init__(node, callback_group, qos_profile)
        self.srv_type = srv_type
        self.srv_name = srv_name
        self._service_name = service_name
        self._request = srv_type.Request._TYPE_SUPPORT
        self._response = srv_type.Response._TYPE_SUPPORT

    def _attach(self, reader: Reader, writer: Writer) -> None:
        self._reader, self._writer = reader, writer

    def _on_matched(self, _endpoint: Any, _status: Any) -> None:
        """Called in a DDS thread when the other side comes or goes."""
        raise NotImplementedError

    @property
    def service_name(self) -> str:
        """The fully qualified name."""
        self._require_alive()
        return self._service_name

    def configure_introspection(self, *_args: Any) -> None:
        """Publish service events, which is not supported."""
        msg = "jfto_dds does not support service introspection"
        raise NotImplementedError(msg)
