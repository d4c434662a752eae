"""`bag replay`: recorded inputs through the real nodes, and their outputs compared."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from pathlib import Path

from rclpy.serialization import deserialize_message

from jfto.bag.comparison import Stamped, TopicComparison, compare_topic
from jfto.bag.contents import BagMessage
from jfto.bag.errors import BagError
from jfto.bag.reader import Bag
from jfto.bag.recorder import BagRecorder
from jfto.bag.replay_clock import ReplayClock
from jfto.bag.replay_node import Output, ReplayEdges, replay_nodes
from jfto.ros_cli.messages import message_class
from jfto_msgs_py.ros import topics

# Without these a node goes on by what was planned: no radio measures the air, a flight not begun.
_MAY_BE_SILENT = {topics.AIR_GAIN, topics.ENERGY_LEFT, topics.LIFT_OFF}


@dataclass(frozen=True)
class Replay:
    """Outputs of a replay in their order, and how each topic compares."""

    outputs: tuple[Output, ...]
    comparisons: tuple[TopicComparison, ...]
    input_count: int

    @property
    def digest(self) -> str:
        """SHA-256 of topics, times and bytes of all outputs."""
        sha = hashlib.sha256()
        for output in self.outputs:
            head = f"{output.topic} {output.stamp_ns} {len(output.data)}\n"
            sha.update(head.encode() + output.data)
        return sha.hexdigest()


def replay_bag(bag: Bag, node_names: list[str], parameters: Path, tolerance_db: float) -> Replay:
    """Feed a bag to nodes by the time of its messages.

    Messages come in the order of (time, topic, place in the bag). Each node gets what was
    recorded, also where another node of the replay publishes it. Raises BagError for a bag that
    lacks an input, JftoError for parameters that do not fit.
    """
    messages = sorted(bag.messages(), key=lambda each: (each.stamp_ns, each.topic))
    if not messages:
        raise BagError(f"{bag.path}: holds no messages.")
    outputs: list[Output] = []
    clock = ReplayClock(messages[0].stamp_ns)
    with replay_nodes(node_names, parameters, clock, outputs) as edges:
        _require_inputs(bag, edges)
        input_count = _feed(messages, edges, clock)
    # Diagnostics and markers are for people; what other nodes act on is compared.
    acted_on = [each for each in outputs if _is_compared(each.topic)]
    published = {topic for each in edges for topic in each.published if _is_compared(topic)}
    comparisons = tuple(
        _compare(topic, messages, acted_on, tolerance_db) for topic in sorted(published)
    )
    return Replay(tuple(acted_on), comparisons, input_count)


def _require_inputs(bag: Bag, edges: list[ReplayEdges]) -> None:
    present = {topic.name for topic in bag.facts.topics if topic.count}
    for each in edges:
        missing = sorted(set(each.inputs) - present - _MAY_BE_SILENT)
        if missing:
            raise BagError(
                f"{bag.path}: holds nothing on {', '.join(missing)}, which {each.node.get_name()} "
                "needs. Record with --all, from before the nodes start."
            )


def _feed(messages: list[BagMessage], edges: list[ReplayEdges], clock: ReplayClock) -> int:
    count = 0
    for message in messages:
        clock.advance(message.stamp_ns)
        for each in edges:
            if message.topic in each.inputs:
                kind, take = each.inputs[message.topic]
                take(deserialize_message(message.data, kind))
                count += 1
    return count


def _is_compared(topic: str) -> bool:
    horizons = {topics.ADJACENCY, topics.POWER_INTERVAL, topics.POWER_SCHEDULE}
    return topic in horizons or topic.endswith(topics.tx_power("").removeprefix("/"))


def _compare(
    topic: str, messages: list[BagMessage], outputs: list[Output], tolerance_db: float
) -> TopicComparison:
    recorded = [
        Stamped(each.stamp_ns, deserialize_message(each.data, message_class(each.type_name)))
        for each in messages
        if each.topic == topic
    ]
    replayed = [Stamped(each.stamp_ns, each.message) for each in outputs if each.topic == topic]
    return compare_topic(topic, recorded, replayed, tolerance_db)


def write_outputs(replay: Replay, path: Path) -> None:
    """Write the outputs as a bag. Raises BagError where that cannot be."""
    recorder = BagRecorder(path)
    known: set[str] = set()
    for output in replay.outputs:
        if output.topic not in known:
            known.add(output.topic)
            recorder.add_topic(output.topic, output.type_name, [])
        recorder.write(output.topic, output.stamp_ns, output.data)
    recorder.close()
