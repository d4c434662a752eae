"""Bags in the making: what is in the file at each moment."""

from __future__ import annotations

import pytest
import yaml
from rosbags.interfaces import (
    Qos,
    QosDurability,
    QosHistory,
    QosLiveliness,
    QosReliability,
    QosTime,
)
from rosbags.rosbag2 import Reader

from jfto.bag.contents import BagError
from jfto.bag.reader import Bag
from jfto.bag.recorder import BagRecorder

INFINITE = QosTime(9223372036, 854775807)
LATCHED = Qos(
    QosHistory.KEEP_LAST, 1, QosReliability.RELIABLE, QosDurability.TRANSIENT_LOCAL,
    INFINITE, INFINITE, QosLiveliness.AUTOMATIC, INFINITE, False,
)  # fmt: skip
# rosbag2 0.26 refuses a version 9 file that lacks one of these.
KEYS = {
    "version", "storage_identifier", "duration", "starting_time", "message_count",
    "topics_with_message_count", "compression_format", "compression_mode", "relative_file_paths",
    "files", "custom_data", "ros_distro",
}  # fmt: skip


def _payload(text):
    data = text.encode() + b"\0"
    return b"\x00\x01\x00\x00" + len(data).to_bytes(4, "little") + data


def _information(path):
    return yaml.safe_load((path / "metadata.yaml").read_text())["rosbag2_bagfile_information"]


def test_metadata_is_there_from_the_start_and_complete(tmp_path):
    """Before the first message metadata.yaml has every key that rosbag2 requires."""
    recorder = BagRecorder(tmp_path / "bag")
    information = _information(tmp_path / "bag")
    assert set(information) == KEYS
    assert information["starting_time"]["nanoseconds_since_epoch"] == 2**63 - 1
    recorder.add_topic("/a", "std_msgs/msg/String", [LATCHED])
    recorder.write("/a", 5, _payload("x"))
    recorder.flush()
    information = _information(tmp_path / "bag")
    assert (information["message_count"], information["files"][0]["message_count"]) == (1, 1)
    profile = information["topics_with_message_count"][0]["topic_metadata"]
    assert set(profile) == {"name", "type", "serialization_format", "offered_qos_profiles",
                            "type_description_hash"}  # fmt: skip
    assert profile["offered_qos_profiles"][0]["durability"] == "transient_local"
    recorder.close()


@pytest.mark.parametrize("compress", [False, True])
def test_what_was_flushed_is_readable_without_closing(compress, tmp_path):
    """A recorder that never closes has lost what came after its last flush, and no more."""
    recorder = BagRecorder(tmp_path / "bag", compress=compress)
    recorder.add_topic("/a", "std_msgs/msg/String", [LATCHED])
    for index in range(10):
        recorder.write("/a", 100 + index, _payload(str(index)))
    recorder.flush()
    recorder.write("/a", 200, _payload("lost"))
    bag = Bag(tmp_path / "bag")
    assert not bag.facts.complete
    assert [message.stamp_ns for message in bag.messages()] == list(range(100, 110))
    assert [message.data for message in bag.messages()] == [_payload(str(i)) for i in range(10)]
    assert bag.facts.topics[0].offered == (LATCHED,)
    recorder.close()
    with Reader(tmp_path / "bag") as reader:
        assert reader.message_count == 11


def test_flushing_often_changes_no_message(tmp_path):
    """Many small chunks read like one."""
    for name, every in (("often", 1), ("never", 1000)):
        recorder = BagRecorder(tmp_path / name)
        recorder.add_topic("/a", "std_msgs/msg/String", [LATCHED])
        for index in range(50):
            recorder.write("/a", index, _payload(str(index)))
            if index % every == 0:
                recorder.flush()
        recorder.close()
    often, never = Bag(tmp_path / "often"), Bag(tmp_path / "never")
    assert often.facts.complete
    assert list(often.messages()) == list(never.messages())


def test_recording_without_messages_is_a_bag(tmp_path):
    """Nothing came: an empty bag that says so, not an error."""
    BagRecorder(tmp_path / "bag").close()
    facts = Bag(tmp_path / "bag").facts
    assert (facts.message_count, facts.duration_ns, facts.complete) == (0, 0, True)


def test_folder_that_exists_is_refused(tmp_path):
    """Nothing is ever overwritten."""
    with pytest.raises(BagError, match="exists"):
        BagRecorder(tmp_path)


def test_full_disk_is_told_and_costs_nothing_before(tmp_path):
    """Where the file cannot grow, the error says so; what was flushed is still a bag."""
    import resource

    recorder = BagRecorder(tmp_path / "bag")
    recorder.add_topic("/a", "std_msgs/msg/String", [LATCHED])
    recorder.write("/a", 1, _payload("kept"))
    recorder.flush()
    size = (tmp_path / "bag" / "bag.mcap").stat().st_size
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size + 1000, before[1]))
    try:
        recorder.write("/a", 2, _payload("x" * 5000))
        with pytest.raises(BagError, match="cannot be written any more: File too large"):
            recorder.flush()
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
    assert [message.data for message in Bag(tmp_path / "bag").messages()] == [_payload("kept")]
    # With room again the rest of that batch follows, and nothing else: not even an index.
    recorder.close()
    facts = Bag(tmp_path / "bag").facts
    assert (facts.message_count, facts.complete) == (2, False)
