"""A node of this process that spins beside the test, in a context of its own."""

from __future__ import annotations

import contextlib
import threading
import time
from collections.abc import Callable, Iterator
from typing import Any

from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node

# For a computer that is busy with other things.
LIMIT_S = 60.0


@contextlib.contextmanager
def spinning_node(name: str, namespace: str = "", **options: Any) -> Iterator[Node]:
    """A node whose callbacks run in a thread until the block ends."""
    context = Context()
    context.init(args=[])
    node = Node(name, namespace=namespace, context=context, **options)
    executor = SingleThreadedExecutor(context=context)
    executor.add_node(node)
    thread = threading.Thread(target=executor.spin)
    thread.start()
    try:
        yield node
    finally:
        executor.shutdown()
        thread.join(LIMIT_S)
        node.destroy_node()
        context.try_shutdown()
        assert not thread.is_alive()


def wait_until(condition: Callable[[], Any], limit_s: float = LIMIT_S) -> None:
    """Wait for what is expected; fails where it does not come."""
    tick, end = threading.Event(), time.monotonic() + limit_s
    while not condition():
        assert time.monotonic() < end
        tick.wait(0.01)
