"""One node of our own on the ROS graph, for the time of a command."""

from __future__ import annotations

import contextlib
import os
import time
from collections.abc import Callable, Iterator
from typing import Any

import click

EXIT_INTERRUPTED = 130
EXIT_TERMINATED = 143

# Discovery is over when the graph has not changed for so long, and is waited for no longer than so.
_QUIET_S = 0.3
_DISCOVERY_LIMIT_S = 5.0
_POLL_S = 0.05


def find_ros() -> None:
    """Make `import rclpy` work: the installed one where there is one, its stand-in elsewhere."""
    import jfto_dds

    jfto_dds.install()


class Terminated(Exception):  # noqa: N818 - it is a request, not a fault
    """The context was shut down from outside, as SIGTERM does."""


class Session:
    """A node and the executor that spins it."""

    def __init__(self, node: Any, executor: Any) -> None:
        self.node = node
        self._executor = executor

    def spin_once(self, timeout_s: float | None = None) -> None:
        """Run what is ready, or wait for it. Raises Terminated when the context is down."""
        from rclpy.executors import ExternalShutdownException

        if not self.node.context.ok():
            raise Terminated
        try:
            self._executor.spin_once(timeout_sec=timeout_s)
        except ExternalShutdownException:
            raise Terminated from None
        if not self.node.context.ok():
            raise Terminated

    def spin_until(self, condition: Callable[[], bool], timeout_s: float | None = None) -> bool:
        """Spin until a condition holds; False on time-out."""
        end = None if timeout_s is None else time.monotonic() + timeout_s
        while not condition():
            left = _POLL_S if end is None else end - time.monotonic()
            if left <= 0:
                return False
            self.spin_once(min(left, _POLL_S))
        return True

    def discover(self, spin_time_s: float) -> None:
        """Listen for `spin_time_s`, and on until the graph has come to rest."""
        begin = changed = time.monotonic()
        picture: Any = None
        while True:
            now = time.monotonic()
            current = (
                self.node.get_topic_names_and_types(),
                self.node.get_service_names_and_types(),
                sorted(self.node.get_node_names_and_namespaces()),
            )
            if current != picture:
                picture, changed = current, now
            rested = now - begin >= spin_time_s and now - changed >= _QUIET_S
            if rested or now - begin >= max(_DISCOVERY_LIMIT_S, spin_time_s):
                return
            self.spin_once(_POLL_S)


@contextlib.contextmanager
def open_session(spin_time_s: float, node_name: str | None = None) -> Iterator[Session]:
    """Join the graph with a hidden node and leave it in the end.

    SIGINT and SIGTERM leave the block by click's Exit with status 130 and 143, without a word.
    """
    find_ros()
    import rclpy
    from rclpy.executors import SingleThreadedExecutor

    rclpy.init(args=[])
    try:
        node = rclpy.create_node(
            node_name or f"_ros2cli_{os.getpid()}", start_parameter_services=False
        )
        executor = SingleThreadedExecutor()
        executor.add_node(node)
        session = Session(node, executor)
        try:
            session.discover(spin_time_s)
            yield session
        finally:
            executor.shutdown()
            node.destroy_node()
    except KeyboardInterrupt:
        raise click.exceptions.Exit(EXIT_INTERRUPTED) from None
    except Terminated:
        raise click.exceptions.Exit(EXIT_TERMINATED) from None
    finally:
        rclpy.try_shutdown()
