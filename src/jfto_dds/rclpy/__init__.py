"""The used part of rclpy, ROS 2 Jazzy's client library for Python, over Eclipse Cyclone DDS.

This package is not imported under this name but as ``rclpy``: see :func:`jfto_dds.install`.
"""

from __future__ import annotations

from typing import Any

from .context import Context
from .executors import Executor, SingleThreadedExecutor
from .node import Node
from .signals import (
    SignalHandlerOptions,
    install_signal_handlers,
    uninstall_signal_handlers,
)
from .task import Future
from .utilities import get_default_context, get_rmw_implementation_identifier, ok
from .utilities import shutdown as _shutdown
from .utilities import try_shutdown as _try_shutdown

__all__ = [
    "create_node",
    "get_default_context",
    "get_global_executor",
    "get_rmw_implementation_identifier",
    "init",
    "ok",
    "shutdown",
    "spin",
    "spin_once",
    "spin_until_future_complete",
    "try_shutdown",
]

_global_executor: Executor | None = None


def init(
    *,
    args: list[str] | None = None,
    context: Context | None = None,
    domain_id: int | None = None,
    signal_handler_options: SignalHandlerOptions | None = None,
) -> None:
    """Initialise ROS communications of a context and take over SIGINT and SIGTERM."""
    if signal_handler_options is None:
        signal_handler_options = (
            SignalHandlerOptions.ALL
            if context is None or context is get_default_context()
            else SignalHandlerOptions.NO
        )
    (get_default_context() if context is None else context).init(args, domain_id=domain_id)
    install_signal_handlers(signal_handler_options)


def get_global_executor() -> Executor:
    """The executor behind ``rclpy.spin``."""
    global _global_executor  # noqa: PLW0603 - one per process, as in rclpy
    if _global_executor is None or _global_executor._is_shutdown:
        _global_executor = SingleThreadedExecutor()
    elif not _global_executor.context.ok():
        _global_executor.shutdown()
        _global_executor = SingleThreadedExecutor()
    return _global_executor


def _end_global_executor() -> None:
    global _global_executor
    executor, _global_executor = _global_executor, None
    if executor is not None:
        executor.shutdown()


def shutdown(*, context: Context | None = None, uninstall_handlers: bool | None = None) -> None:
    """Shut a context down; raises where that was done before."""
    _end_global_executor()
    try:
        _shutdown(context=context)
    finally:
        if uninstall_handlers or (uninstall_handlers is None and context is None):
            uninstall_signal_handlers()


def try_shutdown(*, context: Context | None = None, uninstall_handlers: bool | None = None) -> None:
    """Shut a context down where that has not been done."""
    _end_global_executor()
    _try_shutdown(context=context)
    if uninstall_handlers or (uninstall_handlers is None and context is None):
        uninstall_signal_handlers()


def create_node(node_name: str, **kwargs: Any) -> Node:
    """Create a node; see :class:`rclpy.node.Node`."""
    return Node(node_name, **kwargs)


def spin_once(
    node: Node, *, executor: Executor | None = None, timeout_sec: float | None = None
) -> None:
    """Run one callback of a node, or time out."""
    executor = get_global_executor() if executor is None else executor
    try:
        executor.add_node(node)
        executor.spin_once(timeout_sec=timeout_sec)
    finally:
        executor.remove_node(node)


def spin(node: Node, executor: Executor | None = None) -> None:
    """Run callbacks of a node until shutdown."""
    executor = get_global_executor() if executor is None else executor
    try:
        executor.add_node(node)
        while executor.context.ok() and not executor._is_shutdown:
            executor.spin_once()
    finally:
        executor.remove_node(node)


def spin_until_future_complete(
    node: Node,
    future: Future,
    executor: Executor | None = None,
    timeout_sec: float | None = None,
) -> None:
    """Run callbacks of a node until a future is done."""
    executor = get_global_executor() if executor is None else executor
    try:
        executor.add_node(node)
        executor.spin_until_future_complete(future, timeout_sec)
    finally:
        executor.remove_node(node)
