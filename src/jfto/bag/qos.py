"""Quality of service in bags and in rclpy."""

from __future__ import annotations

from typing import Any

from rosbags.interfaces import (
    Qos,
    QosDurability,
    QosHistory,
    QosLiveliness,
    QosReliability,
    QosTime,
)

# What rosbag2 writes for "no limit".
INFINITE = QosTime(9223372036, 854775807)
_INFINITE_NS = 2**63 - 1


def to_bag(profile: Any) -> Qos:
    """Describe an rclpy profile in a bag."""
    return Qos(
        QosHistory[profile.history.name],
        int(profile.depth),
        QosReliability[profile.reliability.name],
        QosDurability[profile.durability.name],
        _time(profile.deadline),
        _time(profile.lifespan),
        QosLiveliness[profile.liveliness.name],
        _time(profile.liveliness_lease_duration),
        bool(profile.avoid_ros_namespace_conventions),
    )


def _time(duration: Any) -> QosTime:
    nanoseconds = int(duration.nanoseconds)
    if nanoseconds <= 0 or nanoseconds >= _INFINITE_NS:
        return INFINITE
    return QosTime(*divmod(nanoseconds, 10**9))


def offered_by(publishers: list[Any]) -> list[Qos]:
    """The distinct profiles of a topic's publishers, in the order of discovery."""
    found: list[Qos] = []
    for each in publishers:
        profile = to_bag(each.qos_profile)
        if profile not in found:
            found.append(profile)
    return found


def recording_profile(publishers: list[Any], depth: int) -> Any:
    """Profile of a subscription that fits all publishers, as rosbag2's recorder chooses it."""
    from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy

    profiles = [each.qos_profile for each in publishers]
    reliable = all(each.reliability == ReliabilityPolicy.RELIABLE for each in profiles)
    latched = all(each.durability == DurabilityPolicy.TRANSIENT_LOCAL for each in profiles)
    return QoSProfile(
        depth=depth,
        reliability=ReliabilityPolicy.RELIABLE if reliable else ReliabilityPolicy.BEST_EFFORT,
        durability=DurabilityPolicy.TRANSIENT_LOCAL if latched else DurabilityPolicy.VOLATILE,
    )


def playing_profile(offered: list[Qos], depth: int) -> tuple[Any, bool]:
    """Profile of a publisher that stands for the recorded ones, and whether they agreed.

    Where they differed it is reliable and volatile, as in rosbag2.
    """
    from rclpy.duration import Duration
    from rclpy.qos import DurabilityPolicy, LivelinessPolicy, QoSProfile, ReliabilityPolicy

    def wanted(each: Qos) -> tuple[Any, ...]:
        return (
            each.reliability,
            each.durability,
            _finite_ns(each.deadline),
            _finite_ns(each.lifespan),
            each.liveliness,
            _finite_ns(each.liveliness_lease_duration),
        )

    if len({wanted(each) for each in offered}) != 1:
        return QoSProfile(depth=depth), not offered
    profile, first = QoSProfile(depth=depth), offered[0]
    if first.reliability is QosReliability.BEST_EFFORT:
        profile.reliability = ReliabilityPolicy.BEST_EFFORT
    if first.durability is QosDurability.TRANSIENT_LOCAL:
        profile.durability = DurabilityPolicy.TRANSIENT_LOCAL
    if first.liveliness is QosLiveliness.MANUAL_BY_TOPIC:
        profile.liveliness = LivelinessPolicy.MANUAL_BY_TOPIC
    profile.deadline = Duration(nanoseconds=_finite_ns(first.deadline))
    profile.lifespan = Duration(nanoseconds=_finite_ns(first.lifespan))
    lease = _finite_ns(first.liveliness_lease_duration)
    profile.liveliness_lease_duration = Duration(nanoseconds=lease)
    return profile, True


def _finite_ns(limit: QosTime) -> int:
    """Nanoseconds of a limit, 0 where there is none."""
    nanoseconds = limit.sec * 10**9 + limit.nsec
    return nanoseconds if nanoseconds < _INFINITE_NS else 0
