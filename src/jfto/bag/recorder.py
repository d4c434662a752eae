"""Writes a bag while messages come, so that a kill costs no more than the last moments."""

from __future__ import annotations

import contextlib
import os
import re
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml
from mcap.writer import CompressionType, Writer
from rosbags.interfaces import Qos
from rosbags.rosbag2.metadata import dump_qos_v9
from rosbags.typesys import Stores, get_typestore

from jfto.bag.contents import BagError
from jfto.bag.reader import EMPTY_START_NS
from jfto_msgs_py.files import write_file

# Beside the bag: the parameters of the nodes that were recorded, for a replay.
PARAMETERS_NAME = "parameters.yaml"
_VERSION = 9
# It has to name the topics and the beginning; the counts of a killed recording are in the file.
_METADATA_EVERY_S = 10.0


@dataclass(frozen=True)
class Choice:
    """Which topics are recorded: those that are named, or match, or all of them."""

    topics: frozenset[str] = frozenset()
    pattern: re.Pattern[str] | None = None
    everything: bool = False
    excluded: frozenset[str] = frozenset()

    @property
    def is_open_ended(self) -> bool:
        """Whether topics that nobody knows of yet may be wanted."""
        return self.everything or self.pattern is not None

    def wants(self, topic: str) -> bool:
        """Whether a topic is to be recorded."""
        if topic in self.excluded:
            return False
        matches = self.pattern is not None and self.pattern.search(topic) is not None
        return topic in self.topics or self.everything or matches


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
        # By topic: the number of its channel, and what metadata.yaml says of it.
        self._topics: dict[str, tuple[int, dict[str, Any]]] = {}
        self._start_ns, self._end_ns = EMPTY_START_NS, 0
        self.message_count = 0
        self._metadata_due_s = 0.0
        self.flush()

    def add_topic(self, topic: str, type_name: str, offered: list[Qos]) -> None:
        """Announce a topic with the QoS that its publishers offer."""
        known = type_name in self._types.fielddefs
        if type_name not in self._schemas:
            # As rosbag2 does it: a type without a definition is recorded, and only ROS can read it.
            text = self._types.generate_msgdef(type_name, ros_version=2)[0] if known else ""
            self._schemas[type_name] = self._writer.register_schema(
                type_name, "ros2msg" if known else "", text.encode()
            )
        profiles = dump_qos_v9(offered)
        type_hash = self._types.hash_rihs01(type_name) if known else ""
        channel = self._writer.register_channel(
            topic,
            "cdr",
            self._schemas[type_name],
            {"offered_qos_profiles": yaml.safe_dump(profiles), "topic_type_hash": type_hash},
        )
        described = {
            "name": topic,
            "type": type_name,
            "serialization_format": "cdr",
            "offered_qos_profiles": profiles,
            "type_description_hash": type_hash,
        }
        self._topics[topic] = (channel, {"topic_metadata": described, "message_count": 0})
        self._metadata_due_s = 0.0

    def write(self, topic: str, stamp_ns: int, data: bytes) -> None:
        """Add a message of a topic that was announced, received at `stamp_ns`."""
        channel, written = self._topics[topic]
        self._writer.add_message(channel, stamp_ns, data, stamp_ns)
        written["message_count"] += 1
        if not self.message_count:
            self._metadata_due_s = 0.0
        self.message_count += 1
        self._start_ns = min(self._start_ns, stamp_ns)
        self._end_ns = max(self._end_ns, stamp_ns)

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
        topics = [written for _, written in self._topics.values()]
        information = {
            "version": _VERSION,
            "storage_identifier": "mcap",
            **self._span(),
            "topics_with_message_count": topics,
            "compression_format": "",
            "compression_mode": "",
            "relative_file_paths": [file_name],
            "files": [{"path": file_name, **self._span()}],
            "custom_data": None,
            "ros_distro": os.environ.get("ROS_DISTRO", "jazzy"),
        }
        # The dumper in Python takes five times as long.
        dumper = getattr(yaml, "CSafeDumper", yaml.SafeDumper)
        document = {"rosbag2_bagfile_information": information}
        return str(yaml.dump(document, Dumper=dumper, sort_keys=False))

    def _span(self) -> dict[str, Any]:
        return {
            "duration": {"nanoseconds": max(self._end_ns - self._start_ns, 0)},
            "starting_time": {"nanoseconds_since_epoch": self._start_ns},
            "message_count": self.message_count,
        }
