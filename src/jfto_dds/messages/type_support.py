"""What the transport needs to know of a type: its names, its hash and its codec."""

from __future__ import annotations

import functools
from typing import Any

from jfto_dds.messages.decoder import decode_message
from jfto_dds.messages.encoder import ENCAPSULATION, encoder
from jfto_dds.messages.hashes import type_hash


class TypeSupport:
    """Serialises one message type and names it on the network."""

    def __init__(self, full_name: str) -> None:
        self.full_name = full_name

    @functools.cached_property
    def hash(self) -> str:
        """The RIHS01 type hash, ``RIHS01_`` and 64 hexadecimal digits."""
        return type_hash(self.full_name)

    @functools.cached_property
    def _encode(self) -> Any:
        return encoder(self.full_name)

    def serialize(self, message: Any, prefix: bytes = b"") -> bytes:
        """Encode a message: encapsulation header, ``prefix`` (a service header), body."""
        buffer = bytearray(ENCAPSULATION + prefix)
        self._encode(buffer, message)
        return bytes(buffer)

    def deserialize(self, payload: bytes, start: int = 4) -> Any:
        """Decode a payload whose body starts at byte ``start``; raises MalformedPayloadError."""
        return decode_message(payload, self.full_name, start)
