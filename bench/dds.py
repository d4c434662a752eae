"""Latency, throughput and endurance of ROS 2 messages between two processes on one machine.

Runs on jfto_dds, or on a real rclpy where one is installed::

    python bench/dds.py latency --count 2000
    python bench/dds.py throughput --count 24000
    python bench/dds.py cycles --count 1000
"""

from __future__ import annotations

import argparse
import importlib.util
import os
import subprocess
import sys
import time

if importlib.util.find_spec("rclpy") is None:
    import jfto_dds

    jfto_dds.install()

import rclpy
from rclpy.qos import HistoryPolicy, QoSProfile
from std_msgs.msg import Float64MultiArray

# 122 doubles and their layout make one kilobyte of CDR.
_PAYLOAD = [float(number) for number in range(122)]
_LIMIT_S = 60.0
_KEEP_ALL = QoSProfile(history=HistoryPolicy.KEEP_ALL)


def _start(role: str, count: int) -> subprocess.Popen:
    arguments = [sys.executable, __file__, role, "--count", str(count)]
    return subprocess.Popen(arguments, stdout=subprocess.PIPE, text=True)


def echo(count: int) -> None:
    """Send every message back until killed, or for long enough."""
    node = rclpy.create_node("echo")
    publisher = node.create_publisher(Float64MultiArray, "pong", 10)
    node.create_subscription(Float64MultiArray, "ping", publisher.publish, 10)
    executor = rclpy.executors.SingleThreadedExecutor()
    executor.add_node(node)
    end = time.monotonic() + _LIMIT_S + count * 0.01
    while time.monotonic() < end:
        executor.spin_once(timeout_sec=0.5)


def latency(count: int) -> None:
    """Print percentiles of half the round trip."""
    node = rclpy.create_node("ping")
    executor = rclpy.executors.SingleThreadedExecutor()
    executor.add_node(node)
    answers: list[int] = []
    publisher = node.create_publisher(Float64MultiArray, "ping", 10)
    node.create_subscription(
        Float64MultiArray, "pong", lambda _message: answers.append(time.perf_counter_ns()), 10
    )
    peer = _start("echo", count)
    try:
        message = Float64MultiArray(data=_PAYLOAD)
        end = time.monotonic() + _LIMIT_S
        while publisher.get_subscription_count() == 0 or node.count_publishers("pong") == 0:
            if time.monotonic() > end:
                sys.exit("the echo process did not come up")
            executor.spin_once(timeout_sec=0.05)
        halves = []
        for number in range(count):
            answers.clear()
            begin = time.perf_counter_ns()
            publisher.publish(message)
            while not answers:
                executor.spin_once(timeout_sec=1.0)
                if time.perf_counter_ns() - begin > _LIMIT_S * 1e9:
                    sys.exit(f"message {number} was lost")
            halves.append((answers[0] - begin) / 2e3)
    finally:
        peer.kill()
        peer.wait()
    halves.sort()
    for share in (0.5, 0.9, 0.99):
        print(f"latency p{100 * share:.0f} {halves[int(share * (count - 1))]:.0f} us")


def source(count: int) -> None:
    """Publish numbered messages as fast as they are taken."""
    node = rclpy.create_node("source")
    publisher = node.create_publisher(Float64MultiArray, "stream", _KEEP_ALL)
    while publisher.get_subscription_count() == 0:
        time.sleep(0.01)
    for number in range(count):
        publisher.publish(Float64MultiArray(data=[float(number), *_PAYLOAD[1:]]))
    publisher.wait_for_all_acked()


def throughput(count: int) -> None:
    """Print the rate of a reliable stream; fail if a message is lost or out of order."""
    node = rclpy.create_node("sink")
    executor = rclpy.executors.SingleThreadedExecutor()
    executor.add_node(node)
    got: list[float] = []
    node.create_subscription(
        Float64MultiArray, "stream", lambda message: got.append(message.data[0]), _KEEP_ALL
    )
    peer = _start("source", count)
    end = time.monotonic() + _LIMIT_S
    begin = 0.0
    while len(got) < count and time.monotonic() < end:
        executor.spin_once(timeout_sec=0.2)
        if got and not begin:
            begin = time.monotonic()
    elapsed = time.monotonic() - begin
    peer.wait(_LIMIT_S)
    if got != [float(number) for number in range(count)]:
        sys.exit(f"{count - len(got)} of {count} messages were lost or out of order")
    print(f"throughput {count / elapsed:.0f} messages/s, {count} received, 0 lost")


def talker(count: int) -> None:
    """Publish until somebody has listened, then leave."""
    del count
    node = rclpy.create_node("talker")
    publisher = node.create_publisher(Float64MultiArray, "chat", 10)
    end = time.monotonic() + _LIMIT_S
    while publisher.get_subscription_count() == 0 and time.monotonic() < end:
        time.sleep(0.005)
    publisher.publish(Float64MultiArray(data=[1.0]))
    publisher.wait_for_all_acked(rclpy.duration.Duration(seconds=5))
    node.destroy_node()


def listener(count: int) -> None:
    """Leave with status 0 once a message has come."""
    del count
    node = rclpy.create_node("listener")
    got: list[object] = []
    node.create_subscription(Float64MultiArray, "chat", got.append, 10)
    end = time.monotonic() + _LIMIT_S
    while not got and time.monotonic() < end:
        rclpy.spin_once(node, timeout_sec=0.5)
    node.destroy_node()
    if not got:
        sys.exit("nothing heard")


def cycles(count: int) -> None:
    """Start and stop a talker and a listener many times; fail at the first hang."""
    begin = time.monotonic()
    for number in range(count):
        pair = [_start(role, 1) for role in ("talker", "listener")]
        for process in pair:
            try:
                status = process.wait(2 * _LIMIT_S)
            except subprocess.TimeoutExpired:
                for other in pair:
                    other.kill()
                sys.exit(f"cycle {number} hung")
            if status:
                sys.exit(f"cycle {number} ended with status {status}")
        if (number + 1) % 100 == 0:
            print(f"{number + 1} cycles, load {os.getloadavg()[0]:.1f}", flush=True)
    print(f"{count} cycles without a hang, {(time.monotonic() - begin) / count:.2f} s each")


def main() -> None:
    """Run the part that the command line names."""
    parts = {
        part.__name__: part
        for part in (latency, throughput, cycles, echo, source, talker, listener)
    }
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("part", choices=parts)
    parser.add_argument("--count", type=int, default=2000)
    options = parser.parse_args()
    os.environ.setdefault("ROS_DOMAIN_ID", str(1 + os.getpid() % 200))
    rclpy.init(args=[])
    parts[options.part](options.count)
    rclpy.try_shutdown()


if __name__ == "__main__":
    main()
