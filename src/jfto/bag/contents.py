"""What a bag is and holds, and that in words."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime, timedelta
from typing import NamedTuple

from rosbags.interfaces import Qos

from jfto_msgs_py.errors import InputError

_INDENT = "\n" + " " * 19
# What calls of services are published on where somebody asked for it: no topics to their users.
_SERVICE = "/_service_event"


class BagError(InputError):
    """A bag cannot be read, or not be written where it was asked for."""


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
    what is there, and `notes` say what is not.
    """

    files: tuple[str, ...]
    size_bytes: int
    storage: str
    distro: str
    start_ns: int
    duration_ns: int
    topics: tuple[BagTopic, ...]
    complete: bool = True
    notes: tuple[str, ...] = ()

    @property
    def named_topics(self) -> tuple[BagTopic, ...]:
        """Topics without the events of services."""
        return tuple(each for each in self.topics if not each.name.endswith(_SERVICE))

    @property
    def message_count(self) -> int:
        """Messages of all topics."""
        return sum(topic.count for topic in self.topics)


def info_text(facts: BagFacts) -> str:
    """Text of a bag's facts; times of day are local."""
    topics = facts.named_topics
    services = [each for each in facts.topics if each.name.endswith(_SERVICE)]
    listed = [
        f"Topic: {each.name} | Type: {each.type_name} | Count: {each.count} | "
        f"Serialization Format: {each.serialization_format}"
        for each in topics
    ]
    asked = [
        f"Service: {each.name.removesuffix(_SERVICE)} | Type: "
        f"{each.type_name.removesuffix('_Event')} | Events: {each.count}"
        for each in services
    ]
    lines = {
        "Files": _INDENT.join(facts.files),
        "Bag size": _size(facts.size_bytes),
        "Storage id": facts.storage,
        "ROS Distro": facts.distro,
        "Duration": f"{_seconds(facts.duration_ns)}s",
        "Start": _moment(facts.start_ns),
        "End": _moment(facts.start_ns + facts.duration_ns),
        "Messages": str(sum(each.count for each in topics)),
        "Topic information": _INDENT.join(listed),
        "Service": str(len(services)),
        "Service information": _INDENT.join(asked),
    }
    return "\n".join(f"{name + ':':<18} {text}" for name, text in lines.items())


def _size(count: int) -> str:
    power = min((max(count, 1).bit_length() - 1) // 10, 3)
    return f"{count / 1024**power:.{1 if power else 0}f} {('B', 'KiB', 'MiB', 'GiB')[power]}"


def _seconds(nanoseconds: int) -> str:
    return f"{nanoseconds // 10**9}.{nanoseconds % 10**9:09d}"


def _moment(nanoseconds: int) -> str:
    moment = datetime.fromtimestamp(0).astimezone() + timedelta(seconds=nanoseconds // 10**9)
    local = moment.astimezone()
    return f"{local:%b %e %Y %H:%M:%S}.{nanoseconds % 10**9:09d} ({_seconds(nanoseconds)})"
