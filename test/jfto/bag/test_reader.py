"""Reading bags of the real rosbag2, whole and cut off."""

from __future__ import annotations

import shutil
from collections import Counter
from itertools import pairwise

import pytest
from mcap.writer import Writer
from rosbags.interfaces import QosDurability, QosReliability
from rosbags.typesys import Stores, get_typestore

from jfto.bag.contents import BagError
from jfto.bag.reader import Bag

COUNTS = {
    "jazzy_mcap": {"/clock": 115, "/topology": 1, "/uav1/plan": 1, "/uav1/pose": 115,
                   "/uav2/pose": 115},
    "jazzy_sqlite3": {"/clock": 117, "/topology": 1, "/uav1/plan": 1, "/uav1/pose": 117,
                      "/uav2/pose": 117},
    "jazzy_mcap_zstd": {"/clock": 45, "/topology": 1, "/uav1/plan": 1, "/uav1/pose": 45,
                        "/uav2/pose": 45},
}  # fmt: skip


@pytest.mark.parametrize("name", COUNTS)
def test_every_message_is_there_in_order(name, bags):
    """Counts are those recorded, times do not go back, poses hold what was published."""
    messages = list(Bag(bags / name).messages())
    assert Counter(message.topic for message in messages) == COUNTS[name]
    stamps = [message.stamp_ns for message in messages]
    assert stamps == sorted(stamps)
    store = get_typestore(Stores.ROS2_JAZZY)
    poses = [message for message in messages if message.topic == "/uav1/pose"]
    decoded = [store.deserialize_cdr(each.data, each.type_name) for each in poses]
    steps = {round(b.pose.position.x - a.pose.position.x) for a, b in pairwise(decoded)}
    assert steps == {1}


@pytest.mark.parametrize("name", COUNTS)
def test_quality_of_service_is_kept(name, bags):
    """Latched topics and best-effort ones are told apart."""
    topics = {topic.name: topic.offered[0] for topic in Bag(bags / name).facts.topics}
    assert topics["/topology"].durability is QosDurability.TRANSIENT_LOCAL
    assert topics["/uav1/pose"].durability is QosDurability.VOLATILE
    assert topics["/uav2/pose"].reliability is QosReliability.BEST_EFFORT


def test_topics_can_be_chosen(bags):
    """Only messages of the topics named are read, and all of them."""
    bag = Bag(bags / "jazzy_mcap")
    chosen = [m for m in bag.messages() if m.topic == "/uav2/pose"]
    assert list(bag.messages({"/uav2/pose"})) == chosen


def test_file_without_its_end_gives_whole_chunks_only(bags, tmp_path):
    """A file cut in its one chunk has lost that chunk, and says so instead of failing."""
    content = (bags / "jazzy_mcap" / "jazzy_mcap_0.mcap").read_bytes()
    cut = tmp_path / "cut.mcap"
    cut.write_bytes(content[: len(content) // 2])
    bag = Bag(cut)
    assert not bag.facts.complete
    assert list(bag.messages()) == []


def test_file_without_its_index_gives_everything(bags, tmp_path):
    """Only footer and index are gone: all messages are there, with their QoS."""
    content = (bags / "jazzy_mcap_zstd" / "jazzy_mcap_zstd_0.mcap").read_bytes()
    cut = tmp_path / "cut.mcap"
    cut.write_bytes(content[:-100])
    bag, whole = Bag(cut), Bag(bags / "jazzy_mcap_zstd")
    assert list(bag.messages()) == list(whole.messages())
    assert {topic.name: topic.offered for topic in bag.facts.topics} == {
        topic.name: topic.offered for topic in whole.facts.topics
    }


def test_sqlite_folder_without_metadata_is_read(bags, tmp_path):
    """A killed sqlite3 recording lacks metadata.yaml only."""
    shutil.copy(bags / "jazzy_sqlite3" / "jazzy_sqlite3_0.db3", tmp_path)
    facts = Bag(tmp_path).facts
    assert (facts.message_count, facts.complete) == (353, False)


def test_all_parts_of_a_split_recording_are_read(bags, tmp_path):
    """Three databases of ten messages each: all thirty in order, though metadata.yaml is lost."""
    bag = Bag(bags / "split_sqlite3")
    stamps = [message.stamp_ns for message in bag.messages()]
    assert (len(stamps), bag.facts.message_count) == (30, 30)
    assert stamps == sorted(stamps)
    assert bag.facts.files == ("split_0.db3", "split_1.db3", "split_2.db3")
    # The tenth part comes after the second.
    shutil.copytree(bags / "split_sqlite3", tmp_path / "many")
    (tmp_path / "many" / "split_1.db3").rename(tmp_path / "many" / "split_10.db3")
    assert Bag(tmp_path / "many").facts.files[-1] == "split_10.db3"


def test_what_of_a_recording_is_not_read_is_said(bags, tmp_path):
    """A lost metadata.yaml, one part named alone, a part that is gone, two recordings in one."""
    split = bags / "split_sqlite3"
    assert "all 3 files there are read" in Bag(split).facts.notes[0]
    (note,) = Bag(split / "split_1.db3").facts.notes
    assert "split_0.db3, split_2.db3 are not read. Name the folder" in note
    shutil.copytree(split, tmp_path / "gap")
    (tmp_path / "gap" / "split_1.db3").unlink()
    assert "parts 0, 2 are there, others are missing" in Bag(tmp_path / "gap").facts.notes[1]
    assert Bag(bags / "jazzy_mcap").facts.notes == ()
    shutil.copy(bags / "jazzy_mcap" / "jazzy_mcap_0.mcap", tmp_path / "gap")
    with pytest.raises(BagError, match="two recordings or one twice"):
        Bag(tmp_path / "gap")
    shutil.copytree(bags / "jazzy_sqlite3", tmp_path / "lost")
    (tmp_path / "lost" / "jazzy_sqlite3_0.db3").rename(tmp_path / "lost" / "other_0.db3")
    missing, more = Bag(tmp_path / "lost").facts.notes
    assert "jazzy_sqlite3_0.db3 of the recording are missing" in missing
    assert "other_0.db3 are read though" in more


def test_part_that_is_missing_or_empty_is_told(bags, tmp_path):
    """What is there is read, and the bag is not complete."""
    shutil.copytree(bags / "jazzy_mcap", tmp_path / "bag")
    (tmp_path / "bag" / "jazzy_mcap_1.mcap").touch()
    facts = Bag(tmp_path / "bag").facts
    assert (facts.message_count, facts.complete) == (sum(COUNTS["jazzy_mcap"].values()), False)


@pytest.mark.parametrize(("profile", "encoding"), [("", "json"), ("ros1", "ros1")])
@pytest.mark.parametrize("finished", [True, False])
def test_messages_that_are_not_ros2s_are_refused(profile, encoding, finished, tmp_path):
    """Topic and encoding are named before anything is played or decoded."""
    path = tmp_path / "other.mcap"
    with path.open("wb") as file:
        writer = Writer(file)
        writer.start(profile)
        schema = writer.register_schema("Thing", "jsonschema", b"{}")
        channel = writer.register_channel("/thing", encoding, schema)
        writer.add_message(channel, 1, b"{}", 1)
        writer.flush()
        if finished:
            writer.finish()
    with pytest.raises(BagError, match=f"/thing is encoded as {encoding}"):
        Bag(path)


def test_ros2_messages_are_read_whatever_wrote_the_file(tmp_path):
    """An mcap file without the profile of ROS 2, as other recorders write it, is a bag."""
    path = tmp_path / "foxglove.mcap"
    with path.open("wb") as file:
        writer = Writer(file)
        writer.start()
        schema = writer.register_schema("std_msgs/msg/Empty", "ros2msg", b"")
        writer.add_message(writer.register_channel("/e", "cdr", schema), 1, b"\0\1\0\0", 1)
        writer.finish()
    facts = Bag(path).facts
    assert (facts.message_count, facts.complete, facts.topics[0].name) == (1, True, "/e")


@pytest.mark.parametrize("content", [b"", b"hello", b"\x89MCAP0\r\n" + b"\xff" * 50])
def test_damaged_file_is_refused_or_empty(content, tmp_path):
    """No mcap file is refused by name; one that is damaged after its head holds nothing."""
    path = tmp_path / "bad.mcap"
    path.write_bytes(content)
    if content.startswith(b"\x89MCAP"):
        assert Bag(path).facts.message_count == 0
    else:
        with pytest.raises(BagError, match=r"bad\.mcap"):
            Bag(path)


def test_folder_without_bag_is_refused(tmp_path):
    """An empty folder and a missing path are named."""
    with pytest.raises(BagError, match="cannot be read as a bag"):
        Bag(tmp_path)
    with pytest.raises(BagError, match="does not exist"):
        Bag(tmp_path / "nope")


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize(
    ("file", "cut"),
    [
        ("jazzy_mcap_zstd/jazzy_mcap_zstd_0.mcap", 40),
        ("jazzy_mcap_zstd/jazzy_mcap_zstd_0.mcap", 0),
        ("split_sqlite3/split_0.db3", 0),
    ],
)
def test_bytes_changed_at_random_never_crash(seed, file, cut, bags, tmp_path):
    """Whatever is flipped in a file, with its end or without, ends in messages or a BagError."""
    import numpy as np

    rng = np.random.default_rng(seed)
    whole = (bags / file).read_bytes()
    content = bytearray(whole[: len(whole) - cut])
    path = tmp_path / f"flipped{(bags / file).suffix}"
    for _ in range(25):
        damaged = bytearray(content)
        for position in rng.integers(8, len(damaged), size=5):
            damaged[position] = rng.integers(256)
        path.write_bytes(damaged)
        try:
            found = sum(1 for _ in Bag(path).messages())
        except BagError:
            continue
        assert 0 <= found <= 137
