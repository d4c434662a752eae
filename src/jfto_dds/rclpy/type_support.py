"""Checks that a class is a message or a service type."""

from __future__ import annotations

from typing import Any

_HINT = (
    " This might be a ROS 1 message type but it should be a ROS 2 message type. "
    "Make sure to source your ROS 2 workspace after your ROS 1 workspace."
)


def check_for_type_support(msg_or_srv_type: Any) -> None:
    """Raise AttributeError for a class that is no ROS 2 interface."""
    if getattr(type(msg_or_srv_type), "_TYPE_SUPPORT", None) is None:
        name = type(msg_or_srv_type).__name__
        msg = f"type object '{name}' has no attribute '_TYPE_SUPPORT'{_HINT}"
        raise AttributeError(msg)


def check_is_valid_msg_type(msg_type: Any) -> None:
    """Raise for anything but a message class."""
    check_for_type_support(msg_type)
    if not hasattr(msg_type, "get_fields_and_field_types"):
        msg = (
            f"The message type provided is not valid ({msg_type}), "
            "this might be a service or action"
        )
        raise RuntimeError(msg)


def check_is_valid_srv_type(srv_type: Any) -> None:
    """Raise for anything but a service class."""
    check_for_type_support(srv_type)
    if not hasattr(srv_type, "Request"):
        msg = (
            f"The service type provided is not valid ({srv_type}), "
            "this might be a message or action"
        )
        raise RuntimeError(msg)
