"""Writes a bag while messages come, so that a kill costs no more than the last moments."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Literal, cast

from rosbags.interfaces import Connection, Qos
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.rosbag2.enums import CompressionFormat, CompressionMode
from rosbags.rosbag2.errors import WriterError
from rosbags.rosbag2.metadata import dump_qos_v9
from rosbags.rosbag2.storage_mcap import McapWriter
from rosbags.typesys import Stores, get_typestore

from jfto.bag.errors import BagError
from jfto.bag.reader import EMPTY_START_NS
from jfto_msgs_py.files import write_file

# Beside the bag: the parameters of the nodes that were recorded, for a replay.
PARAMETERS_NAME = "parameters.yaml"
_VERSION: Literal[9] = 9


class BagRecorder:
    """An mcap bag in the making.

    `flush` puts everything written so far into the file as a whole chunk, and metadata.yaml beside
    it: call it once a second or so. What came after the last flush is what a kill costs.
    """

    def __init__(self, path: Path, *, compress: bool = False) -> None:
        """Make the folder. Raises BagError if it is there already, or cannot be made."""
        self.path = path
        try:
            self._writer = Writer(path, version=_VERSION, storage_plugin=StoragePlugin.MCAP)
            if compress:
                self._writer.set_compression(CompressionMode.STORAGE, CompressionFormat.ZSTD)
            self._writer.open()
        except (WriterError, OSError) as error:
            raise BagError(f"{path}: {error}") from None
        self._types = get_typestore(Stores.ROS2_JAZZY)
        self._connections: dict[str, Connection] = {}
        self._written = True
        self.message_count = 0
        self.flush()

    def knows_type(self, type_name: str) -> bool:
        """Whether messages of a type can be recorded: its definition belongs into the bag."""
        return type_name in self._types.fielddefs

    def add_topic(self, topic: str, type_name: str, offered: list[Qos]) -> None:
        """Announce a topic with the QoS that its publishers offer."""
        self._connections[topic] = self._writer.add_connection(
            topic, type_name, typestore=self._types, offered_qos_profiles=offered
        )
        self._written = True

    def write(self, topic: str, stamp_ns: int, data: bytes) -> None:
        """Add a message of a topic that was announced. Raises BagError, as on a full disk."""
        with self._told():
            self._writer.write(self._connections[topic], stamp_ns, data)
        self.message_count += 1
        self._written = True

    def flush(self) -> None:
        """Bring what was written since the last flush to the file."""
        if not self._written:
            return
        storage = cast("McapWriter", self._writer.storage)
        with self._told():
            if storage.chunk.bio.tell():
                storage.close_chunk()
            storage.bio.flush()
        write_file(self.path / "metadata.yaml", self._metadata(storage.path.name))
        self._written = False

    def close(self) -> None:
        """Finish the file with its index, and metadata.yaml."""
        with self._told():
            self._writer.close()

    @contextlib.contextmanager
    def _told(self) -> Iterator[None]:
        try:
            yield
        except OSError as error:
            raise BagError(
                f"{self.path}: cannot be written any more: {error.strerror}. What was written "
                "before can be read."
            ) from None

    def _metadata(self, file_name: str) -> str:
        """metadata.yaml of what is in the file so far, every key that version 9 requires."""
        import yaml

        writer = self._writer
        empty = self.message_count == 0
        span: dict[str, Any] = {
            "duration": {
                "nanoseconds": 0 if empty else writer.max_timestamp - writer.min_timestamp
            },
            "starting_time": {
                "nanoseconds_since_epoch": EMPTY_START_NS if empty else writer.min_timestamp
            },
            "message_count": self.message_count,
        }
        topics = [
            {
                "topic_metadata": {
                    "name": each.topic,
                    "type": each.msgtype,
                    "serialization_format": "cdr",
                    "offered_qos_profiles": dump_qos_v9(list(each.ext.offered_qos_profiles)),
                    "type_description_hash": each.digest,
                },
                "message_count": writer.counts[each.id],
            }
            for each in cast("list[Any]", writer.connections)
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
            "ros_distro": "rosbags",
        }
        # Written twice a second: in Python it took as much of a core as all the rest of recording.
        dumper = getattr(yaml, "CSafeDumper", yaml.SafeDumper)
        document = {"rosbag2_bagfile_information": information}
        return str(yaml.dump(document, Dumper=dumper, sort_keys=False))
