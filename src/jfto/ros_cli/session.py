"""One node of our own on the ROS graph, for the time of a command."""

from __future__ import annotations

import contextlib
import os
import signal
import threading
import time
from collections.abc import Callable, Iterator
from typing import Any

from jfto_msgs_py.ros.installation import require_ros

EXIT_INTERRUPTED = 130
EXIT_TERMINATED = 143

# Discovery is over when the graph has not changed for so long, and is waited for no longer than so.
_QUIET_S = 0.3
_DISCOVERY_LIMIT_S = 5.0
_POLL_S = 0.05


class Stopped(Exception):  # noqa: N818 - it is a request, not a fault
    """SIGINT or SIGTERM came; `status` is what the process should end with."""

    def __init__(self, status: int) -> None:
        super().__init__(status)
        self.status = status


class StopSignals:
    """Notes SIGINT and SIGTERM, so that work ends between two callbacks and never inside one."""

    def __init__(self) -> None:
        self.status = 0

    def __enter__(self) -> StopSignals:
        self._previous: dict[int, Any] = {}
        if threading.current_thread() is threading.main_thread():
            for number in (signal.SIGINT, signal.SIGTERM):
                self._previous[number] = signal.signal(number, self._note)
        return self

    def _note(self, number: int, _frame: Any) -> None:
        self.status = EXIT_INTERRUPTED if number == signal.SIGINT else EXIT_TERMINATED

    def __exit__(self, *_exception: object) -> None:
        for number, previous in self._previous.items():
            signal.signal(number, previous)


class Session:
    """A node and the executor that spins it."""

    def __init__(self, node: Any, executor: Any, signals: StopSignals) -> None:
        self.node = node
        self._executor = executor
        self._signals = signals

    def spin_once(self, timeout_s: float) -> None:
        """Run what is ready, or wait for it. Raises Stopped after SIGINT or SIGTERM."""
        if self._signals.status:
            raise Stopped(self._signals.status)
        self._executor.spin_once(timeout_sec=min(timeout_s, _POLL_S))
        if self._signals.status:
            raise Stopped(self._signals.status)

    def spin_until(self, condition: Callable[[], bool], timeout_s: float | None = None) -> bool:
        """Spin until a condition holds; False on time-out."""
        end = None if timeout_s is None else time.monotonic() + timeout_s
        while not condition():
            left = _POLL_S if end is None else end - time.monotonic()
            if left <= 0:
                return False
            self.spin_once(left)
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
def open_session(
    spin_time_s: float, node_name: str | None = None, *, sim_time: bool = False
) -> Iterator[Session]:
    """Join the graph with a node, hidden unless named, and leave it in the end.

    With `sim_time` the node's clock is /clock. SIGINT and SIGTERM leave the block by Stopped.
    """
    require_ros()
    import rclpy
    from rclpy.executors import SingleThreadedExecutor
    from rclpy.parameter import Parameter
    from rclpy.signals import SignalHandlerOptions

    with StopSignals() as signals:
        rclpy.init(args=[], signal_handler_options=SignalHandlerOptions.NO)
        try:
            name = node_name or f"_ros2cli_{os.getpid()}"
            node = rclpy.create_node(
                name,
                start_parameter_services=False,
                parameter_overrides=[Parameter("use_sim_time", value=sim_time)],
            )
            executor = SingleThreadedExecutor()
            executor.add_node(node)
            session = Session(node, executor, signals)
            try:
                session.discover(spin_time_s)
                yield session
            finally:
                executor.shutdown()
                node.destroy_node()
        finally:
            rclpy.try_shutdown()
