"""Quality of service of an endpoint, plain, and its translation to and from Cyclone's policies."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from cyclonedds.core import Policy, Qos

INFINITE_NS = 2**63 - 1
# DDS policy ids, as in ``last_policy_id`` of an incompatible-QoS status.
POLICY_NAMES = {2: "DURABILITY", 4: "DEADLINE", 8: "LIVELINESS", 11: "RELIABILITY"}


@dataclass(frozen=True)
class QosSettings:
    """What an endpoint offers or asks for; durations in nanoseconds, None is infinite."""

    depth: int = 10
    keep_all: bool = False
    reliable: bool = True
    transient_local: bool = False
    deadline_ns: int | None = None
    lifespan_ns: int | None = None
    manual_liveliness: bool = False
    lease_ns: int | None = None


def _history(settings: QosSettings) -> Any:
    if settings.keep_all:
        return Policy.History.KeepAll
    return Policy.History.KeepLast(max(settings.depth, 1))


def to_cyclone(settings: QosSettings, user_data: bytes, *, writer: bool) -> Qos:
    """Translate as rmw_cyclonedds does, representation and USER_DATA included."""
    lease = INFINITE_NS if settings.lease_ns is None else settings.lease_ns
    liveliness = (
        Policy.Liveliness.ManualByTopic(lease)
        if settings.manual_liveliness
        else Policy.Liveliness.Automatic(lease)
    )
    policies = [
        _history(settings),
        Policy.Reliability.Reliable(INFINITE_NS)
        if settings.reliable
        else Policy.Reliability.BestEffort,
        Policy.Durability.TransientLocal
        if settings.transient_local
        else Policy.Durability.Volatile,
        liveliness,
        Policy.DataRepresentation(use_cdrv0_representation=True, use_xcdrv2_representation=False),
        Policy.Userdata(user_data),
    ]
    if settings.deadline_ns is not None:
        policies.append(Policy.Deadline(settings.deadline_ns))
    if writer:
        policies.append(Policy.WriterDataLifecycle(autodispose=False))
        if settings.lifespan_ns is not None:
            policies.append(Policy.Lifespan(settings.lifespan_ns))
        if settings.transient_local:
            policies.append(Policy.DurabilityService(0, _history(settings), -1, -1, -1))
    return Qos(*policies)


def _finite(duration_ns: int | None) -> int | None:
    return None if duration_ns is None or duration_ns >= INFINITE_NS else duration_ns


def from_cyclone(qos: Qos) -> QosSettings:
    """Read back what a discovered endpoint announces; history is only known for local ones."""
    history = qos[Policy.History]
    liveliness = qos[Policy.Liveliness]
    durability = qos[Policy.Durability]
    deadline = qos[Policy.Deadline]
    lifespan = qos[Policy.Lifespan]
    return QosSettings(
        depth=getattr(history, "depth", 0),
        keep_all=history == Policy.History.KeepAll,
        reliable=isinstance(qos[Policy.Reliability], Policy.Reliability.Reliable),
        transient_local=durability is not None and durability != Policy.Durability.Volatile,
        deadline_ns=_finite(getattr(deadline, "deadline", None)),
        lifespan_ns=_finite(getattr(lifespan, "lifespan", None)),
        manual_liveliness=isinstance(liveliness, Policy.Liveliness.ManualByTopic),
        lease_ns=_finite(getattr(liveliness, "lease_duration", None)),
    )
