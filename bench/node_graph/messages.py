"""Whether messages are lost between two processes, and how long one takes."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import rclpy
from rclpy.qos import HistoryPolicy, QoSProfile
from std_msgs.msg import MultiArrayDimension, UInt8MultiArray

from node_graph.watcher import domain

_SIZE = 1000
_RATE_HZ = 2000.0
_BURST = 8
_LIMIT_S = 120.0
# Nobody may fall behind: the talker waits for room, the listener keeps all.
_KEPT = QoSProfile(depth=2000, history=HistoryPolicy.KEEP_LAST)


def messages(count: int) -> None:
    """Send `count` reliable messages of 1 kB from a process of its own, and count them here."""
    path = os.pathsep.join([str(Path(__file__).parents[1]), os.environ.get("PYTHONPATH", "")])
    environment = {**os.environ, "ROS_DOMAIN_ID": str(domain()), "PYTHONPATH": path}
    context = rclpy.context.Context()
    rclpy.init(args=[], context=context, domain_id=domain())
    node = rclpy.create_node("listener", context=context)
    executor = rclpy.executors.SingleThreadedExecutor(context=context)
    executor.add_node(node)
    numbers: list[int] = []
    took_us: list[float] = []

    def hear(message: UInt8MultiArray) -> None:
        now_ns = time.monotonic_ns()
        offset, stamp_ns = message.layout.data_offset, int(message.layout.dim[0].label)
        numbers.append(offset)
        took_us.append((now_ns - stamp_ns) / 1e3)

    node.create_subscription(UInt8MultiArray, "/bench", hear, _KEPT)
    command = [sys.executable, "-m", "node_graph.messages", str(count)]
    talker = subprocess.Popen(command, env=environment)
    end_s = time.monotonic() + _LIMIT_S
    while len(numbers) < count and time.monotonic() < end_s:
        executor.spin_once(timeout_sec=0.2)
    talker.wait(20)
    executor.shutdown()
    node.destroy_node()
    context.try_shutdown()
    missing = sorted(set(range(count)) - set(numbers))
    p50, p90, p99 = np.percentile(took_us, [50, 90, 99])
    print(
        f"{count} messages of 1 kB, {len(missing)} lost, in order: {numbers == sorted(numbers)}; "
        f"one way p50 {p50:.0f}  p90 {p90:.0f}  p99 {p99:.0f} us, load {os.getloadavg()[0]:.1f}"
    )
    if missing:
        sys.exit(f"lost: {missing[:10]}")


def talk(count: int) -> None:
    """The talker's process."""
    rclpy.init(args=[])
    node = rclpy.create_node("talker")
    publisher = node.create_publisher(UInt8MultiArray, "/bench", _KEPT)
    while not publisher.get_subscription_count():
        time.sleep(0.05)
    time.sleep(0.5)
    message = UInt8MultiArray(data=bytes(_SIZE))
    message.layout.dim = [MultiArrayDimension()]
    for number in range(count):
        message.layout.data_offset = number
        message.layout.dim[0].label = str(time.monotonic_ns())
        publisher.publish(message)
        if number % _BURST == _BURST - 1:
            time.sleep(_BURST / _RATE_HZ)
    publisher.wait_for_all_acked(rclpy.duration.Duration(seconds=_LIMIT_S))
    node.destroy_node()
    rclpy.shutdown()


if __name__ == "__main__":
    talk(int(sys.argv[1]))
