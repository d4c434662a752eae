"""Writes a bag while messages come, so that a kill costs no more than the last moments."""

from __future__ import annotations

import contextlib
import os
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, cast

import yaml
from mcap.writer import CompressionType, Writer
from rosbags.interfaces import Qos
from rosbags.rosbag2.metadata import dump_qos_v9
from rosbags.typesys import Stores, get_typestore

from jfto.bag.errors import BagError
from jfto.bag.reader import EMPTY_START_NS
from jfto_msgs_py.files import write_file

# Beside the bag: the parameters of the nodes that were recorded, for a replay.
PARAMETERS_NAME = "parameters.yaml"
_VERSION = 9
# It only has to name the topics; the counts of a killed recording come from the file itself.
_METADATA_EVERY_S = 10.0


@dataclass
class _Topic:
    """A topic that is recorded and how many messages of it came."""

    channel: int
    type_name: str
    offered: list[dict[str, Any]]
    type_hash: str
    count: int = 0


class BagRecorder:
    """An mcap bag in the making.

    `flush` puts everything written so far into the file as a whole chunk: call it once a second or
    so. What came after the last flush is what a kill costs.
    """

    def __init__(self, path: Path, *, compress: bool = False) -> None:
        """Make the folder. Raises BagError if it is there already, or cannot be made."""
        self.path = path
        try:
            path.mkdir(parents=True)
            self._stream = (path / f"{path.name}.mcap").open("xb")
        except OSError as error:
            raise BagError(f"{path}: no bag can be made there: {error.strerror}.") from None
        kind = CompressionType.ZSTD if compress else CompressionType.NONE
        self._writer = Writer(self._stream, compression=kind)
        self._writer.start("ros2", "jfto")
        self._broken = False
        self._types = get_typestore(Stores.ROS2_JAZZY)
        self._schemas: dict[str, int] = {}
        self._topics: dict[str, _Topic] = {}
        self._span_ns = (EMPTY_START_NS, 0)
        self._metadata_due_s = 0.0
        self.flush()

    @property
    def message_count(self) -> int:
        """Messages of all topics."""
        return sum(topic.count for topic in self._topics.values())

    def add_topic(self, topic: str, type_name: str, offered: list[Qos]) -> None:
        """Announce a topic with the QoS that its publishers offer."""
        known = type_name in self._types.fielddefs
        if type_name not in self._schemas:
            # As rosbag2 does it: a type without a definition is recorded, and only ROS can read it.
            text = self._types.generate_msgdef(type_name, ros_version=2)[0] if known else ""
            self._schemas[type_name] = self._writer.register_schema(
                type_name, "ros2msg" if known else "", text.encode()
            )
        profiles = cast("list[dict[str, Any]]", dump_qos_v9(offered))
        type_hash = self._types.hash_rihs01(type_name) if known else ""
        channel = self._writer.register_channel(
            topic,
            "cdr",
            self._schemas[type_name],
            {"offered_qos_profiles": yaml.safe_dump(profiles), "topic_type_hash": type_hash},
        )
        self._topics[topic] = _Topic(channel, type_name, profiles, type_hash)
        self._metadata_due_s = 0.0

    def write(self, topic: str, stamp_ns: int, data: bytes) -> None:
        """Add a message of a topic that was announced, received at `stamp_ns`."""
        known = self._topics[topic]
        self._writer.add_message(known.channel, stamp_ns, data, stamp_ns)
        if not known.count:
            self._metadata_due_s = 0.0
        known.count += 1
        self._span_ns = (min(self._span_ns[0], stamp_ns), max(self._span_ns[1], stamp_ns))

    def flush(self) -> None:
        """Bring what was written since the last flush to the file. Raises BagError: disk full."""
        with self._told():
            self._writer.flush()
        if time.monotonic() >= self._metadata_due_s:
            write_file(self.path / "metadata.yaml", self._metadata())
            self._metadata_due_s = time.monotonic() + _METADATA_EVERY_S

    def close(self) -> None:
        """Finish the file with its index, and metadata.yaml. Raises BagError: disk full.

        A file that could not be written to is left as it is: whole up to where the disk was full.
        """
        if self._broken:
            with contextlib.suppress(OSError):
                self._stream.close()
            return
        text = self._metadata()
        with self._told(), self._stream:
            self._writer.add_metadata("rosbag2", {"serialized_metadata": text})
            self._writer.finish()
        write_file(self.path / "metadata.yaml", text)

    @contextlib.contextmanager
    def _told(self) -> Iterator[None]:
        try:
            yield
        except OSError as error:
            self._broken = True
            raise BagError(
                f"{self.path}: cannot be written any more: {error.strerror}. What was written "
                "before can be read."
            ) from None

    def _metadata(self) -> str:
        """metadata.yaml of what is in the file so far, every key that version 9 requires."""
        file_name = f"{self.path.name}.mcap"
        start_ns, end_ns = self._span_ns
        span: dict[str, Any] = {
            "duration": {"nanoseconds": max(end_ns - start_ns, 0)},
            "starting_time": {"nanoseconds_since_epoch": start_ns},
            "message_count": self.message_count,
        }
        topics = [
            {
                "topic_metadata": {
                    "name": name,
                    "type": topic.type_name,
                    "serialization_format": "cdr",
                    "offered_qos_profiles": topic.offered,
                    "type_description_hash": topic.type_hash,
                },
                "message_count": topic.count,
            }
            for name, topic in self._topics.items()
        ]
        information = {
            "version": _VERSION,
            "storage_identifier": "mcap",
            **span,
            "topics_with_message_count": topics,
            "compression_format": "",
            "compression_mode": "",
            "relative_file_paths": [file_name],
            "files": [{"path": file_name, **span}],
            "custom_data": None,
            "ros_distro": os.environ.get("ROS_DISTRO", "jazzy"),
        }
        # The dumper in Python takes as much of a core as all the rest of recording.
        dumper = getattr(yaml, "CSafeDumper", yaml.SafeDumper)
        document = {"rosbag2_bagfile_information": information}
        return str(yaml.dump(document, Dumper=dumper, sort_keys=False))
