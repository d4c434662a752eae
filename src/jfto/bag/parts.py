"""One file of a bag: with its index, or as far as a killed recorder came."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterator
from pathlib import Path
from typing import cast

from mcap import records
from mcap.stream_reader import StreamReader
from mcap.writer import MCAP0_MAGIC
from rosbags.interfaces import ConnectionExtRosbag2, Qos
from rosbags.rosbag2 import Reader
from rosbags.rosbag2.metadata import parse_qos

from jfto.bag.contents import BagError, BagMessage, BagTopic


class IndexedPart:
    """A file with its index, or a compressed folder, through rosbags.

    `span_ns` is when its first and its last message came, empty where there is none.
    """

    complete = True

    def __init__(self, path: Path) -> None:
        """Open it. Raises BagError."""
        self._path = path
        self.span_ns: tuple[int, ...] = ()
        try:
            with Reader(path) as reader:
                self.topics = [
                    BagTopic(each.topic, each.msgtype, *_extra(each.ext), each.msgcount)
                    for each in reader.connections
                ]
                if reader.message_count:
                    # rosbags counts the last nanosecond too.
                    self.span_ns = (reader.start_time, reader.end_time - 1)
        except Exception as error:  # noqa: BLE001 - a damaged file can fail in any way
            raise BagError(f"{path}: cannot be read as a bag: {error}") from None

    def messages(self, topics: Collection[str] | None) -> Iterator[BagMessage]:
        """Messages by time. Raises BagError where damage is met."""
        try:
            with Reader(self._path) as reader:
                chosen = [c for c in reader.connections if topics is None or c.topic in topics]
                # None chosen would mean all.
                for connection, stamp_ns, data in reader.messages(chosen) if chosen else ():
                    yield BagMessage(stamp_ns, connection.topic, connection.msgtype, bytes(data))
        except Exception as error:  # noqa: BLE001 - damaged bytes can fail in any way
            raise BagError(f"{self._path}: damaged: {error}") from None


def _extra(extra: object) -> tuple[str, tuple[Qos, ...]]:
    found = cast("ConnectionExtRosbag2", extra)
    return found.serialization_format, tuple(found.offered_qos_profiles)


class ScannedPart:
    """An mcap file read from front to back, as far as it goes: it needs no index."""

    def __init__(self, path: Path) -> None:
        """Read all whole records. Raises BagError if it is no mcap file."""
        self.complete = False
        self._channels: dict[int, tuple[records.Channel, str]] = {}
        self._types: dict[int, str] = {}
        self._messages: list[BagMessage] = []
        counts: Counter[int] = Counter()
        with path.open("rb") as file:
            if file.read(len(MCAP0_MAGIC)) != MCAP0_MAGIC:
                what = "is no mcap file" if file.tell() else "is empty"
                raise BagError(f"{path}: {what}, nothing can be recovered.")
            file.seek(0)
            limit = path.stat().st_size
            try:
                for record in StreamReader(file, False, False, True, limit).records:
                    self._take(record, counts)
                self.complete = True
            except Exception:  # noqa: BLE001, S110 - damaged bytes can fail in any way
                # What follows damage cannot be trusted; what came before is whole.
                pass
        self._messages.sort(key=lambda each: each.stamp_ns)
        ends = self._messages[:1] + self._messages[-1:]
        self.span_ns = tuple(each.stamp_ns for each in ends)
        self.topics = [
            BagTopic(each.topic, kind, each.message_encoding, _profiles(each), counts[number])
            for number, (each, kind) in self._channels.items()
        ]

    def _take(self, record: records.McapRecord, counts: Counter[int]) -> None:
        if isinstance(record, records.Schema):
            self._types[record.id] = record.name
        elif isinstance(record, records.Channel):
            self._channels[record.id] = (record, self._types.get(record.schema_id, ""))
        elif isinstance(record, records.Message):
            channel, kind = self._channels[record.channel_id]
            message = BagMessage(record.log_time, channel.topic, kind, record.data)
            self._messages.append(message)
            counts[record.channel_id] += 1

    def messages(self, topics: Collection[str] | None) -> Iterator[BagMessage]:
        """Messages by time."""
        return (each for each in self._messages if topics is None or each.topic in topics)


def _profiles(channel: records.Channel) -> tuple[Qos, ...]:
    try:
        return tuple(parse_qos(channel.metadata.get("offered_qos_profiles", "")))
    except Exception:  # noqa: BLE001 - a damaged description of QoS must not cost the messages
        return ()


def open_part(file: Path) -> IndexedPart | ScannedPart:
    """One file. Raises BagError also where its messages are not those of ROS 2."""
    part: IndexedPart | ScannedPart
    try:
        part = IndexedPart(file)
    except BagError:
        if file.suffix != ".mcap":
            raise
        part = ScannedPart(file)
    for topic in part.topics:
        if topic.serialization_format != "cdr":
            raise BagError(
                f"{file}: {topic.name} is encoded as {topic.serialization_format or 'nothing'}, "
                "not as ROS 2 does it (cdr). Convert the file to a ROS 2 bag first."
            )
    return part
