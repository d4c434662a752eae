"""Messages to bytes and back."""

from __future__ import annotations

from typing import Any

from jfto_dds.messages.decoder import MalformedPayloadError

from ._rclpy_pybind11 import RMWError
from .type_support import check_for_type_support


def serialize_message(message: Any) -> bytes:
    """Encode a message as CDR with its encapsulation header."""
    message_type = type(message)
    check_for_type_support(message_type)
    return message_type._TYPE_SUPPORT.serialize(message)


def deserialize_message(serialized_message: bytes, message_type: Any) -> Any:
    """Decode a message; raises RMWError where the bytes are none of its kind."""
    check_for_type_support(message_type)
    if not isinstance(serialized_message, bytes):
        msg = (
            "rclpy_deserialize(): incompatible function arguments. The following argument types "
            "are supported:\n    1. (arg0: bytes, arg1: object) -> object\n\n"
            f"Invoked with: {serialized_message!r}, {message_type!r}"
        )
        raise TypeError(msg)
    if not serialized_message:
        # rmw leaves the message as it was constructed.
        return message_type()
    try:
        return message_type._TYPE_SUPPORT.deserialize(serialized_message)
    except MalformedPayloadError as error:
        # rmw's words; what exactly is wrong is in the cause.
        msg = "failed to deserialize ROS message: rmw_serialize: invalid data size"
        raise RMWError(msg) from error
