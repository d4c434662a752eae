"""Profiles to what goes on the network, and back."""

from __future__ import annotations

from jfto_dds.wire.qos_settings import QosSettings

from .duration import Duration
from .qos import (
    DeadlineBestAvailable,
    DurabilityPolicy,
    HistoryPolicy,
    LivelinessPolicy,
    QoSProfile,
    ReliabilityPolicy,
)


def _finite_ns(duration: Duration) -> int | None:
    nanoseconds = duration.nanoseconds
    return nanoseconds if 0 < nanoseconds < DeadlineBestAvailable.nanoseconds else None


def to_settings(profile: QoSProfile, peers: list[QosSettings], *, writer: bool) -> QosSettings:
    """Resolve a profile as rmw does; ``peers`` decide what "best available" means."""
    reliable = profile.reliability != ReliabilityPolicy.BEST_EFFORT
    transient = profile.durability == DurabilityPolicy.TRANSIENT_LOCAL
    manual = profile.liveliness == LivelinessPolicy.MANUAL_BY_TOPIC
    if profile.reliability == ReliabilityPolicy.BEST_AVAILABLE and not writer:
        reliable = bool(peers) and all(peer.reliable for peer in peers)
    if profile.durability == DurabilityPolicy.BEST_AVAILABLE:
        transient = writer or (bool(peers) and all(peer.transient_local for peer in peers))
    if profile.liveliness == LivelinessPolicy.BEST_AVAILABLE:
        manual = bool(peers) and all(peer.manual_liveliness for peer in peers) and not writer
    return QosSettings(
        depth=profile.depth or 1,
        keep_all=profile.history == HistoryPolicy.KEEP_ALL,
        reliable=reliable,
        transient_local=transient,
        deadline_ns=_finite_ns(profile.deadline),
        lifespan_ns=_finite_ns(profile.lifespan),
        manual_liveliness=manual,
        lease_ns=_finite_ns(profile.liveliness_lease_duration),
    )


def from_settings(settings: QosSettings) -> QoSProfile:
    """Describe an endpoint of the network; infinite durations read as rmw's infinity."""

    def duration(value_ns: int | None) -> Duration:
        return Duration(nanoseconds=2**63 - 1 if value_ns is None else value_ns)

    return QoSProfile(
        history=HistoryPolicy.KEEP_ALL if settings.keep_all else HistoryPolicy.KEEP_LAST,
        depth=settings.depth,
        reliability=(
            ReliabilityPolicy.RELIABLE if settings.reliable else ReliabilityPolicy.BEST_EFFORT
        ),
        durability=(
            DurabilityPolicy.TRANSIENT_LOCAL
            if settings.transient_local
            else DurabilityPolicy.VOLATILE
        ),
        lifespan=duration(settings.lifespan_ns),
        deadline=duration(settings.deadline_ns),
        liveliness=(
            LivelinessPolicy.MANUAL_BY_TOPIC
            if settings.manual_liveliness
            else LivelinessPolicy.AUTOMATIC
        ),
        liveliness_lease_duration=duration(settings.lease_ns),
    )
