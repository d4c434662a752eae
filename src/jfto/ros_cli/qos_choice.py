"""Which quality of service a command subscribes or publishes with."""

from __future__ import annotations

import copy
from dataclasses import dataclass
from typing import Any

import click

PRESETS = (
    "unknown",
    "default",
    "system_default",
    "sensor_data",
    "services_default",
    "parameters",
    "parameter_events",
    "action_status_default",
    "best_available",
)
HISTORIES = ("system_default", "keep_last", "keep_all", "unknown")
RELIABILITIES = ("system_default", "reliable", "best_effort", "unknown", "best_available")
DURABILITIES = ("system_default", "transient_local", "volatile", "unknown", "best_available")


@dataclass(frozen=True)
class QosWish:
    """A preset, and the policies that the user asked for by name."""

    preset: str
    depth: int | None = None
    history: str | None = None
    reliability: str | None = None
    durability: str | None = None

    @property
    def is_explicit(self) -> bool:
        """Whether any single policy was asked for."""
        return any((self.depth, self.history, self.reliability, self.durability))


def wished_profile(wish: QosWish) -> Any:
    """Profile of the preset with the named policies put in."""
    from rclpy.qos import (
        QoSDurabilityPolicy,
        QoSHistoryPolicy,
        QoSPresetProfiles,
        QoSReliabilityPolicy,
    )

    profile = copy.deepcopy(QoSPresetProfiles.get_from_short_key(wish.preset))
    if wish.history:
        profile.history = QoSHistoryPolicy.get_from_short_key(wish.history)
    if wish.depth is not None:
        profile.depth = wish.depth
    elif wish.durability == "transient_local" and profile.depth == 0:
        profile.depth = 1
    if wish.reliability:
        profile.reliability = QoSReliabilityPolicy.get_from_short_key(wish.reliability)
    if wish.durability:
        profile.durability = QoSDurabilityPolicy.get_from_short_key(wish.durability)
    return profile


def subscription_profile(node: Any, topic: str, wish: QosWish) -> Any:
    """Profile that fits all publishers of a topic, unless single policies were asked for."""
    from rclpy.qos import DurabilityPolicy, ReliabilityPolicy

    profile = wished_profile(wish)
    publishers = node.get_publishers_info_by_topic(topic)
    if wish.is_explicit or not publishers:
        return profile
    reliable = sum(
        each.qos_profile.reliability == ReliabilityPolicy.RELIABLE for each in publishers
    )
    latched = sum(
        each.qos_profile.durability == DurabilityPolicy.TRANSIENT_LOCAL for each in publishers
    )
    if reliable == len(publishers):
        profile.reliability = ReliabilityPolicy.RELIABLE
    else:
        if reliable:
            _say_some("QoSReliabilityPolicy.RELIABLE", "QoSReliabilityPolicy.BEST_EFFORT")
        profile.reliability = ReliabilityPolicy.BEST_EFFORT
    if latched == len(publishers):
        profile.durability = DurabilityPolicy.TRANSIENT_LOCAL
    else:
        if latched:
            _say_some("QoSDurabilityPolicy.TRANSIENT_LOCAL", "QoSDurabilityPolicy.VOLATILE")
        profile.durability = DurabilityPolicy.VOLATILE
    return profile


def _say_some(wanted: str, instead: str) -> None:
    click.echo(
        f"Some, but not all, publishers are offering {wanted}. Falling back to {instead} as it "
        "will connect to all publishers"
    )
