"""One node of our own on the ROS graph, for the time of a command."""

from __future__ import annotations

import contextlib
import os
import signal
import threading
import time
from collections.abc import Callable, Iterator
from typing import Any

import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.signals import SignalHandlerOptions

EXIT_INTERRUPTED = 130
EXIT_TERMINATED = 143

# On a busy computer the first nodes are found late.
_ALONE_S = 2.0
# Nodes on one computer announce themselves every 0.3 s.
_QUIET_S = 0.8
_DISCOVERY_LIMIT_S = 6.0
# How long a signal may go unnoticed.
_POLL_S = 0.05


class Stopped(Exception):  # noqa: N818 - it is a request, not a fault
    """SIGINT or SIGTERM came; `status` is what the process should end with."""

    def __init__(self, status: int) -> None:
        super().__init__(status)
        self.status = status


class StopSignals:
    """Notes SIGINT and SIGTERM, so that work ends between two callbacks and never inside one.

    Once one has come the process is ending, and others are ignored to its end: launch and a
    terminal send several, which must not cut the closing of files short.
    """

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
        for each in self._previous:
            signal.signal(each, signal.SIG_IGN)

    def __exit__(self, *_exception: object) -> None:
        if not self.status:
            for number, previous in self._previous.items():
                signal.signal(number, previous)


class Session:
    """A node and the executor that spins it. Whatever waits raises Stopped after a signal."""

    def __init__(self, node: Any, executor: Any, signals: StopSignals) -> None:
        self.node = node
        self._executor = executor
        self._signals = signals

    def run_ready(self) -> None:
        """Run one callback if one is ready; never waits, never raises Stopped."""
        self._executor.spin_once(timeout_sec=0)

    def spin_until(self, condition: Callable[[], bool], timeout_s: float | None = None) -> bool:
        """Spin until a condition holds; False on time-out."""
        end = None if timeout_s is None else time.monotonic() + timeout_s
        while not condition():
            left_s = _POLL_S if end is None else end - time.monotonic()
            if left_s <= 0:
                return False
            # One and the same time-out lets rclpy keep what it found ready for the next call.
            self._executor.spin_once(timeout_sec=min(left_s, _POLL_S))
            self._check()
        return True

    def pause(self, seconds: float) -> None:
        """Wait without spinning."""
        end = time.monotonic() + seconds
        self._check()
        while (left_s := end - time.monotonic()) > 0:
            time.sleep(min(left_s, _POLL_S))
            self._check()

    def _check(self) -> None:
        if self._signals.status:
            raise Stopped(self._signals.status)

    def discover(self, spin_time_s: float) -> None:
        """Listen for `spin_time_s`, and on until somebody was found and the graph is at rest."""
        begin = changed = time.monotonic()
        picture: Any = None
        while True:
            self.pause(2 * _POLL_S)
            now = time.monotonic()
            names = self.node.get_node_names_and_namespaces()
            services = self.node.get_service_names_and_types()
            current = (sorted(names), self.node.get_topic_names_and_types(), services)
            if current != picture:
                picture, changed = current, now
            wanted_s = spin_time_s if len(names) > 1 else max(spin_time_s, _ALONE_S)
            rested = now - begin >= wanted_s and now - changed >= _QUIET_S
            if rested or now - begin >= max(spin_time_s, _DISCOVERY_LIMIT_S):
                return


@contextlib.contextmanager
def open_session(spin_time_s: float = 0.0, node_name: str | None = None) -> Iterator[Session]:
    """Join the graph with a node, hidden unless named, and leave it in the end.

    Without a `spin_time_s` nobody is listened for before. SIGINT and SIGTERM leave the block by
    Stopped.
    """
    with StopSignals() as signals:
        rclpy.init(args=[], signal_handler_options=SignalHandlerOptions.NO)
        try:
            name = node_name or f"_ros2cli_{os.getpid()}"
            node = rclpy.create_node(name, start_parameter_services=False)
            executor = SingleThreadedExecutor()
            executor.add_node(node)
            try:
                session = Session(node, executor, signals)
                if spin_time_s:
                    session.discover(spin_time_s)
                yield session
            finally:
                # In this order: rclpy aborts the process where a context ends under an executor.
                executor.shutdown()
                node.destroy_node()
        finally:
            rclpy.try_shutdown()
