"""What a bag is and holds."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

from rosbags.interfaces import Qos


@dataclass(frozen=True)
class BagTopic:
    """A topic of a bag, with the QoS profiles that its publishers offered."""

    name: str
    type_name: str
    serialization_format: str
    offered: tuple[Qos, ...]
    count: int


class BagMessage(NamedTuple):
    """One message, received at `stamp_ns`."""

    stamp_ns: int
    topic: str
    type_name: str
    data: bytes


@dataclass(frozen=True)
class BagFacts:
    """Times are ns since the epoch.

    `complete` is False where the recording was killed or files are missing; the facts are those of
    what is there.
    """

    files: tuple[str, ...]
    size_bytes: int
    storage: str
    distro: str
    start_ns: int
    duration_ns: int
    topics: tuple[BagTopic, ...]
    complete: bool = True

    @property
    def message_count(self) -> int:
        """Messages of all topics."""
        return sum(topic.count for topic in self.topics)
