"""Rules of readers and writers."""

from __future__ import annotations

import threading

import rclpy
from std_msgs.msg import String

JOINS = 100


def test_peers_are_counted_while_some_join() -> None:
    """A subscription that joins while subscriptions are counted makes no count fail."""
    context = rclpy.context.Context()
    rclpy.init(args=[], context=context)
    node = rclpy.create_node("counter", context=context)
    publisher = node.create_publisher(String, "peers", 10)
    node.create_subscription(String, "peers", print, 10)
    over = threading.Event()

    def join() -> None:
        for _ in range(JOINS):
            node.destroy_subscription(node.create_subscription(String, "peers", print, 10))
        over.set()

    joiner = threading.Thread(target=join)
    joiner.start()
    counts = set()
    while not over.is_set():
        counts.add(publisher.get_subscription_count())
    joiner.join()
    node.destroy_node()
    context.try_shutdown()
    assert counts <= {0, 1, 2}
