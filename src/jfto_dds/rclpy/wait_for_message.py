"""Waiting for a single message."""

from __future__ import annotations

import time
from typing import Any

from .executors import SingleThreadedExecutor


def wait_for_message(
    msg_type: Any,
    node: Any,
    topic: str,
    *,
    qos_profile: Any = 1,
    time_to_wait: float = -1,
) -> tuple[bool, Any]:
    """Wait for one message on a topic; ``(False, None)`` on time-out or shutdown."""
    received: list[Any] = []
    subscription = node.create_subscription(msg_type, topic, received.append, qos_profile)
    executor = SingleThreadedExecutor(context=node.context)
    former = node.executor
    end = None if time_to_wait < 0 else time.monotonic() + time_to_wait
    try:
        executor.add_node(node)
        while not received and node.context.ok():
            left = None if end is None else end - time.monotonic()
            if left is not None and left <= 0:
                break
            executor.spin_once(left)
    finally:
        executor.remove_node(node)
        node.executor = former
        node.destroy_subscription(subscription)
    return (True, received[0]) if received else (False, None)
