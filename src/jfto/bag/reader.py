"""One way to read all bags: mcap and sqlite3, whole or left unfinished by a kill."""

from __future__ import annotations

import dataclasses
from collections import Counter
from collections.abc import Collection, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol, cast

import yaml
from rosbags.interfaces import ConnectionExtRosbag2, Qos
from rosbags.rosbag2 import Reader
from rosbags.rosbag2.errors import ReaderError
from rosbags.rosbag2.metadata import parse_qos

from jfto.bag.errors import BagError
from jfto.bag.mcap_scan import McapScan, read_metadata_text, scan_mcap

EMPTY_START_NS = 2**63 - 1


@dataclass(frozen=True)
class BagTopic:
    """A topic of a bag, with the QoS profiles that its publishers offered."""

    name: str
    type_name: str
    serialization_format: str
    offered: tuple[Qos, ...]
    count: int


@dataclass(frozen=True)
class BagMessage:
    """One message: received at `stamp_ns`, the `sequence`-th of its topic."""

    topic: str
    type_name: str
    stamp_ns: int
    sequence: int
    data: bytes


@dataclass(frozen=True)
class BagFacts:
    """What a bag is and holds; times are ns since the epoch.

    `complete` is False for a recording that was killed; its facts are those of what was recovered.
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


class _Source(Protocol):
    facts: BagFacts

    def raw(self) -> Iterator[tuple[str, str, int, bytes]]:
        """Topic, type, time and bytes of each message, by time."""


class Bag:
    """A bag that was opened; read as often as wanted."""

    def __init__(self, path: Path) -> None:
        """Open a folder, or an mcap or db3 file. Raises BagError."""
        self.path = path
        if not path.exists():
            raise BagError(f"Bag path '{path}' does not exist!")
        self._source = _open(path)
        self.facts = self._source.facts

    def messages(self, topics: Collection[str] | None = None) -> Iterator[BagMessage]:
        """Messages of the topics named (None: all) by time; equal times in the order written."""
        counts: dict[str, int] = {}
        for topic, type_name, stamp_ns, data in self._source.raw():
            sequence = counts.get(topic, 0)
            counts[topic] = sequence + 1
            if topics is None or topic in topics:
                yield BagMessage(topic, type_name, stamp_ns, sequence, data)


def _open(path: Path) -> _Source:
    readable = path
    databases = sorted(path.glob("*.db3")) if path.is_dir() else []
    if databases and not (path / "metadata.yaml").exists():
        # What a killed sqlite3 recording leaves: the database is whole, only its description lacks.
        readable = databases[0]
    try:
        return _Finished(readable)
    except (ReaderError, OSError, AssertionError, ValueError) as error:
        files = sorted(path.glob("*.mcap")) if path.is_dir() else [path]
        if not files and not databases:
            text = "it has no metadata.yaml, and no .mcap or .db3 file"
            raise BagError(f"{path}: cannot be read as a bag: {text}.") from None
        if not files or any(each.suffix != ".mcap" for each in files):
            raise BagError(f"{path}: cannot be read as a bag: {error}") from None
        return _Unfinished(path, files)


class _Finished:
    """A bag with its index, through rosbags."""

    def __init__(self, path: Path) -> None:
        self._path = path
        with Reader(path) as reader:
            topics: dict[str, BagTopic] = {}
            for each in reader.connections:
                extra = cast("ConnectionExtRosbag2", each.ext)
                topic = BagTopic(
                    each.topic,
                    each.msgtype,
                    extra.serialization_format,
                    tuple(extra.offered_qos_profiles),
                    each.msgcount,
                )
                topics[each.topic] = _merged(topics.get(each.topic), topic)
            empty = reader.message_count == 0
            written = _embedded_metadata(path)
            order = [each["topic_metadata"]["name"] for each in written["topics"]]
            self.facts = BagFacts(
                files=_file_names(path, written["files"]),
                size_bytes=_size_bytes(path),
                storage="sqlite3" if _is_sqlite(path) else "mcap",
                distro=reader.ros_distro or written["distro"],
                start_ns=EMPTY_START_NS if empty else reader.start_time,
                # rosbags counts the last nanosecond too.
                duration_ns=0 if empty else reader.duration - 1,
                topics=tuple(
                    sorted(
                        topics.values(),
                        key=lambda each: order.index(each.name) if each.name in order else 0,
                    )
                ),
            )

    def raw(self) -> Iterator[tuple[str, str, int, bytes]]:
        try:
            with Reader(self._path) as reader:
                for connection, stamp_ns, data in reader.messages():
                    yield connection.topic, connection.msgtype, stamp_ns, bytes(data)
        except ReaderError as error:
            raise BagError(f"{self._path}: damaged: {error}") from None


class _Unfinished:
    """mcap files without an index, read from front to back."""

    def __init__(self, path: Path, files: list[Path]) -> None:
        self._scans = [scan_mcap(each) for each in files]
        stamps = [message.stamp_ns for scan in self._scans for message in scan.messages]
        self.facts = BagFacts(
            files=tuple(each.name if path.is_dir() else str(each) for each in files),
            size_bytes=_size_bytes(path),
            storage="mcap",
            distro="unknown",
            start_ns=min(stamps, default=EMPTY_START_NS),
            duration_ns=max(stamps, default=0) - min(stamps, default=0),
            topics=_topics_of(self._scans),
            complete=all(scan.complete for scan in self._scans),
        )

    def raw(self) -> Iterator[tuple[str, str, int, bytes]]:
        found = [
            (message.stamp_ns, scan.channels[message.channel], message.data)
            for scan in self._scans
            for message in scan.messages
        ]
        for stamp_ns, channel, data in sorted(found, key=lambda each: each[0]):
            yield channel.topic, channel.type_name, stamp_ns, data


def _topics_of(scans: list[McapScan]) -> tuple[BagTopic, ...]:
    found: dict[str, BagTopic] = {}
    for scan in scans:
        counts = Counter(message.channel for message in scan.messages)
        for number, channel in scan.channels.items():
            topic = BagTopic(
                channel.topic,
                channel.type_name,
                channel.encoding,
                _profiles(channel.qos_text),
                counts[number],
            )
            found[channel.topic] = _merged(found.get(channel.topic), topic)
    return tuple(found.values())


def _profiles(text: str) -> tuple[Qos, ...]:
    try:
        return tuple(parse_qos(text))
    except (ReaderError, KeyError, TypeError):
        # A damaged description of QoS must not cost the messages.
        return ()


def _merged(known: BagTopic | None, topic: BagTopic) -> BagTopic:
    """A topic that several files or connections have."""
    if known is None:
        return topic
    offered = tuple(dict.fromkeys((*known.offered, *topic.offered)))
    return dataclasses.replace(topic, offered=offered, count=known.count + topic.count)


def _embedded_metadata(path: Path) -> dict[str, Any]:
    """Order of topics, names of files and distribution as metadata.yaml or the mcap file has them.

    rosbags leaves them out, or sorts them.
    """
    text = ""
    if (path / "metadata.yaml").exists():
        text = (path / "metadata.yaml").read_text("utf-8")
    elif path.suffix == ".mcap":
        text = read_metadata_text(path)
    found: dict[str, Any] = yaml.safe_load(text) or {}
    found = found.get("rosbag2_bagfile_information", found)
    return {
        "topics": found.get("topics_with_message_count", []),
        "files": found.get("relative_file_paths", []),
        "distro": found.get("ros_distro", "unknown"),
    }


def _file_names(path: Path, listed: list[str]) -> tuple[str, ...]:
    return tuple(listed) if path.is_dir() else (str(path),)


def _is_sqlite(path: Path) -> bool:
    return path.suffix == ".db3" or any(path.glob("*.db3*"))


def _size_bytes(path: Path) -> int:
    files = [path] if path.is_file() else [each for each in path.iterdir() if each.is_file()]
    return sum(each.stat().st_size for each in files)
