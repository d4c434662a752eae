"""The part of rosidl_runtime_py that command line tools need: messages to and from plain data."""

from .convert import get_message_slot_types, message_to_csv, message_to_ordereddict, message_to_yaml
from .set_message import set_message_fields

__all__ = [
    "get_message_slot_types",
    "message_to_csv",
    "message_to_ordereddict",
    "message_to_yaml",
    "set_message_fields",
]
