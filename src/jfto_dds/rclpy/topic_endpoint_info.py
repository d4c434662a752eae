"""What is known of an endpoint on the network."""

from __future__ import annotations

import enum
from dataclasses import dataclass

from .qos import HistoryPolicy, QoSProfile
from .type_hash import TypeHash


class TopicEndpointTypeEnum(enum.IntEnum):
    """Publisher or subscription."""

    INVALID = 0
    PUBLISHER = 1
    SUBSCRIPTION = 2


def _duration(nanoseconds: int) -> str:
    return "Infinite" if nanoseconds >= 2**63 - 1 else f"{nanoseconds} nanoseconds"


@dataclass
class TopicEndpointInfo:
    """One publisher or subscription: its node, type and QoS."""

    node_name: str = ""
    node_namespace: str = ""
    topic_type: str = ""
    topic_type_hash: TypeHash | None = None
    endpoint_type: TopicEndpointTypeEnum = TopicEndpointTypeEnum.INVALID
    endpoint_gid: tuple[int, ...] | list[int] = ()
    qos_profile: QoSProfile | None = None

    def __str__(self) -> str:
        profile = self.qos_profile
        assert profile is not None
        history = profile.history.name
        if profile.history == HistoryPolicy.KEEP_LAST:
            history += f" ({profile.depth})"
        gid = ".".join(f"{byte:02x}" for byte in self.endpoint_gid)
        lease = _duration(profile.liveliness_lease_duration.nanoseconds)
        return "\n".join(
            [
                f"Node name: {self.node_name}",
                f"Node namespace: {self.node_namespace}",
                f"Topic type: {self.topic_type}",
                f"Topic type hash: {self.topic_type_hash}",
                f"Endpoint type: {self.endpoint_type.name}",
                f"GID: {gid}",
                "QoS profile:",
                f"  Reliability: {profile.reliability.name}",
                f"  History (Depth): {history}",
                f"  Durability: {profile.durability.name}",
                f"  Lifespan: {_duration(profile.lifespan.nanoseconds)}",
                f"  Deadline: {_duration(profile.deadline.nanoseconds)}",
                f"  Liveliness: {profile.liveliness.name}",
                f"  Liveliness lease duration: {lease}",
            ]
        )
