"""Helpers around the default context and command lines."""

from __future__ import annotations

import sys
import threading

from ._arguments import split_arguments
from .context import Context

_lock = threading.Lock()
_default: Context | None = None


def get_default_context(*, shutting_down: bool = False) -> Context:
    """Return the default context; a new one is made after a shutdown."""
    global _default  # noqa: PLW0603 - one per process, as in rclpy
    with _lock:
        context = _default
        if shutting_down:
            _default = None
        if context is None:
            context = Context()
            if not shutting_down:
                _default = context
        return context


def ok(*, context: Context | None = None) -> bool:
    """Whether a context is initialised and not shut down."""
    return (get_default_context() if context is None else context).ok()


def shutdown(*, context: Context | None = None) -> None:
    """Shut a context down; raises where it is down already."""
    (get_default_context(shutting_down=True) if context is None else context).shutdown()


def try_shutdown(*, context: Context | None = None) -> None:
    """Shut a context down if that has not been done."""
    if context is not None:
        context.try_shutdown()
        return
    get_default_context(shutting_down=True).try_shutdown()


def remove_ros_args(args: list[str] | None = None) -> list[str]:
    """Return what is left of a command line without its ROS arguments."""
    return split_arguments(sys.argv if args is None else args)[1]


def get_rmw_implementation_identifier() -> str:
    """Name the middleware whose conventions hold."""
    return "rmw_cyclonedds_cpp"


def get_available_rmw_implementations() -> set[str]:
    """Name the middlewares that can be used."""
    return {get_rmw_implementation_identifier()}


def timeout_sec_to_nsec(timeout_sec: float | None) -> int:
    """Convert a time-out to nanoseconds; None and negative mean for ever, -1."""
    if timeout_sec is None or timeout_sec < 0:
        return -1
    return int(timeout_sec * 1e9)
