"""A flight on record: topics, tracks and powers of a bag, without any ROS.

    python examples/read_a_bag.py [BAG]

Without an argument the bag of the test suite is read: four UAVs for 26 slots.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from rosbags.typesys import Stores, get_typestore

from jfto.bag.reader import Bag

TYPES = get_typestore(Stores.ROS2_JAZZY)
DEFAULT = Path(__file__).parents[1] / "test/data/bags/tiny_flight"


def main(path: str | None = None) -> None:
    """Print what a bag holds, how far each UAV flew, and which powers were set."""
    bag = Bag(Path(path) if path else DEFAULT)  # mcap or sqlite3, whole or cut off by a kill
    facts = bag.facts
    print(f"{facts.message_count} messages in {facts.duration_ns / 1e9:.0f} s, {facts.storage}")
    for topic in facts.topics:
        print(f"  {topic.count:5} {topic.name}  {topic.type_name}")

    poses = [each.name for each in facts.topics if each.name.endswith("/pose")]
    for name in sorted(poses):
        track_m = np.array([_point(each) for each in _messages(bag, name)])
        print(f"{name}: {np.linalg.norm(np.diff(track_m, axis=0), axis=1).sum():.0f} m flown")

    powers = [each.name for each in facts.topics if each.name.endswith("/jfto/tx_power")]
    for name in sorted(powers):
        dbm = [message.data for message in _messages(bag, name)]
        print(f"{name}: {min(dbm):.1f} to {max(dbm):.1f} dBm")


def _messages(bag: Bag, topic: str):
    for each in bag.messages([topic]):
        yield TYPES.deserialize_cdr(each.data, each.type_name)


def _point(message) -> tuple[float, float, float]:
    place = message.pose.position
    return place.x, place.y, place.z


if __name__ == "__main__":
    main(*sys.argv[1:2])
