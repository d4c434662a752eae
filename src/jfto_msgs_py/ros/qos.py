"""The quality-of-service profiles that the graph uses."""

from __future__ import annotations

from typing import Any


def latched() -> Any:
    """Reliable and transient local, depth 1: a late joiner gets the last value at once."""
    return _kept(1)


def events() -> Any:
    """Reliable and transient local, depth 100: a late joiner gets what has happened so far."""
    return _kept(100)


def sensor() -> Any:
    """Best effort, volatile, depth 5: the newest measurement matters, an old one does not."""
    from rclpy.qos import qos_profile_sensor_data

    return qos_profile_sensor_data


def default() -> Any:
    """Reliable, volatile, depth 10."""
    from rclpy.qos import QoSProfile

    return QoSProfile(depth=10)


def clock() -> Any:
    """Best effort, volatile, depth 1: what rclpy's nodes subscribe to /clock with."""
    from rclpy.qos import QoSProfile, ReliabilityPolicy

    return QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)


def reports() -> Any:
    """Best effort, volatile, depth 20: from many nodes at once, and soon followed by others."""
    from rclpy.qos import QoSProfile, ReliabilityPolicy

    return QoSProfile(depth=20, reliability=ReliabilityPolicy.BEST_EFFORT)


def _kept(depth: int) -> Any:
    from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy

    return QoSProfile(
        depth=depth,
        reliability=ReliabilityPolicy.RELIABLE,
        durability=DurabilityPolicy.TRANSIENT_LOCAL,
    )
