"""Quality of service in bags and in rclpy."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from rosbags.interfaces import (
    Qos,
    QosDurability,
    QosHistory,
    QosLiveliness,
    QosReliability,
    QosTime,
)

# Publishers do not tell their history: what rosbag2 and rclpy take where nothing is said.
_DEPTH = 10
# Of what is played and not kept for late joiners: a burst must not push out what is on its way.
_PLAYED_DEPTH = 1000


def offered_by(publishers: list[Any]) -> list[Qos]:
    """The distinct profiles of a topic's publishers, as a bag describes them."""
    return list(dict.fromkeys(_described(each.qos_profile) for each in publishers))


def _described(profile: Any) -> Qos:
    return Qos(
        QosHistory.KEEP_LAST,
        profile.depth or _DEPTH,
        QosReliability[profile.reliability.name],
        QosDurability[profile.durability.name],
        _time(profile.deadline),
        _time(profile.lifespan),
        QosLiveliness[profile.liveliness.name],
        _time(profile.liveliness_lease_duration),
        bool(profile.avoid_ros_namespace_conventions),
    )


def _time(duration: Any) -> QosTime:
    return QosTime(*divmod(int(duration.nanoseconds), 10**9))


def playing_profile(offered: Sequence[Qos]) -> tuple[Any, bool]:
    """Profile of a publisher that stands for the recorded ones, and whether they agreed.

    Where they differed it is reliable and volatile, as in rosbag2.
    """
    from rclpy.qos import DurabilityPolicy, LivelinessPolicy, QoSProfile, ReliabilityPolicy

    profile = QoSProfile(depth=_PLAYED_DEPTH)
    # History is the publisher's own affair.
    if len({each[2:] for each in offered}) != 1:
        return profile, not offered
    first = offered[0]
    if first.reliability is QosReliability.BEST_EFFORT:
        profile.reliability = ReliabilityPolicy.BEST_EFFORT
    if first.durability is QosDurability.TRANSIENT_LOCAL:
        profile.durability = DurabilityPolicy.TRANSIENT_LOCAL
        profile.depth = _DEPTH
    if first.liveliness is QosLiveliness.MANUAL_BY_TOPIC:
        profile.liveliness = LivelinessPolicy.MANUAL_BY_TOPIC
    profile.deadline = _duration(first.deadline)
    profile.lifespan = _duration(first.lifespan)
    profile.liveliness_lease_duration = _duration(first.liveliness_lease_duration)
    return profile, True


def _duration(limit: QosTime) -> Any:
    from rclpy.duration import Duration

    # rosbag2 has written its "no limit" as more than rclpy can hold.
    return Duration(nanoseconds=min(limit.sec * 10**9 + limit.nsec, 2**63 - 1))
