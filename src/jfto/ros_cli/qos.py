"""Which quality of service a command subscribes or publishes with."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy

_DEPTH = 10


@dataclass(frozen=True)
class QosWish:
    """What the user asked for by name, as ros2cli spells it; None where nothing."""

    depth: int | None = None
    reliability: str | None = None
    durability: str | None = None


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


def wished(profile: QoSProfile, wish: QosWish) -> QoSProfile:
    """A profile with what the user asked for put in."""
    return QoSProfile(
        depth=profile.depth if wish.depth is None else wish.depth,
        reliability=ReliabilityPolicy[wish.reliability.upper()]
        if wish.reliability
        else profile.reliability,
        durability=DurabilityPolicy[wish.durability.upper()]
        if wish.durability
        else profile.durability,
    )
