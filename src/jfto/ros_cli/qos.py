"""Which quality of service a command subscribes or publishes with."""

from __future__ import annotations

from typing import Any

from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy

_DEPTH = 10


def fitting_profile(publishers: list[Any], depth: int = _DEPTH) -> QoSProfile:
    """Profile of a subscription that fits all publishers of a topic, best effort without any."""
    profiles = [each.qos_profile for each in publishers]
    reliable = {each.reliability for each in profiles} == {ReliabilityPolicy.RELIABLE}
    latched = {each.durability for each in profiles} == {DurabilityPolicy.TRANSIENT_LOCAL}
    return QoSProfile(
        depth=depth,
        reliability=ReliabilityPolicy.RELIABLE if reliable else ReliabilityPolicy.BEST_EFFORT,
        durability=DurabilityPolicy.TRANSIENT_LOCAL if latched else DurabilityPolicy.VOLATILE,
    )


def wished(
    profile: QoSProfile,
    *,
    qos_depth: int | None = None,
    qos_reliability: str | None = None,
    qos_durability: str | None = None,
) -> QoSProfile:
    """A profile with what the user asked for by name put in, None where nothing."""
    if qos_depth is not None:
        profile.depth = qos_depth
    if qos_reliability is not None:
        profile.reliability = ReliabilityPolicy[qos_reliability.upper()]
    if qos_durability is not None:
        profile.durability = DurabilityPolicy[qos_durability.upper()]
    return profile
