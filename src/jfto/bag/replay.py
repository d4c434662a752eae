"""`bag replay`: recorded inputs through the nodes' cores, and their outputs compared."""

from __future__ import annotations

import contextlib
import hashlib
from collections.abc import Callable, Collection, Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from rclpy.serialization import deserialize_message, serialize_message
from rosbags.typesys import Stores, get_typestore

from jfto.bag.comparison import Stamped, TopicComparison, compare_topic
from jfto.bag.contents import BagError, BagMessage
from jfto.bag.reader import Bag
from jfto.bag.recorder import BagRecorder
from jfto.planning.scenario_file import load_node_parameters
from jfto.ros_cli.messages import message_class
from jfto_msgs_py.core import Core, CoreRun
from jfto_msgs_py.errors import MessageError
from jfto_msgs_py.ros import topics
from jfto_msgs_py.ros.intake import Input
from jfto_msgs_py.scenario.options import resolve
from jfto_power.core import power_core
from jfto_power.node.power_node import power_inputs, power_messages
from jfto_power.options import PowerOptions
from jfto_topology.core import topology_core
from jfto_topology.node.topology_node import topology_inputs, topology_messages
from jfto_topology.options import TopologyOptions

# Without these a node goes on by what was planned: no radio measures the air, a flight not begun.
_MAY_BE_SILENT = {topics.AIR_GAIN, topics.ENERGY_LEFT, topics.LIFT_OFF}
_TYPES = get_typestore(Stores.ROS2_JAZZY)


@dataclass(frozen=True)
class Output:
    """What a node would have published, when, as the object and as bytes of its fields alone."""

    topic: str
    type_name: str
    stamp_ns: int
    message: Any
    data: bytes


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


@dataclass(frozen=True)
class Replayed:
    """One node's part in a replay: its core, and the edges that the node has too.

    `messages` makes topics and messages of a step's outputs; those of `compared` are what other
    nodes act on.
    """

    node_name: str
    core: Core[Any]
    inputs: Sequence[Input]
    messages: Callable[[Any, int], Iterable[tuple[str, Any]]]
    compared: tuple[str, ...]


def _topology(parameters: Path) -> Replayed:
    values = load_node_parameters(parameters, "topology_node")
    core = topology_core(*resolve(values, TopologyOptions))
    compared = (topics.ADJACENCY, topics.POWER_INTERVAL)
    return Replayed("topology_node", core, topology_inputs(core), topology_messages, compared)


def _power(parameters: Path) -> Replayed:
    scenario, options = resolve(load_node_parameters(parameters, "power_node"), PowerOptions)
    # With full budgets: an account in a file is that of another run.
    core = power_core(scenario, options)
    inputs = power_inputs(core, scenario.fleet.ids)
    compared = (topics.POWER_SCHEDULE, *map(topics.tx_power, core.served))
    return Replayed("power_node", core, inputs, power_messages, compared)


# Name for the command line: how the node's part is made of a parameter file.
NODES: dict[str, Callable[[Path], Replayed]] = {"topology": _topology, "power": _power}


def replay_bag(bag: Bag, node_names: list[str], parameters: Path, tolerance_db: float) -> Replay:
    """Feed a bag to nodes' cores by the time of its messages.

    Messages come in the order of (time, topic, place in the bag). Each core gets what was
    recorded, also where another node of the replay publishes it. Raises BagError for a bag that
    lacks an input, JftoError for parameters that do not fit.
    """
    messages = sorted(bag.messages(), key=lambda each: (each.stamp_ns, each.topic))
    if not messages:
        raise BagError(f"{bag.path}: holds no messages.")
    if not parameters.is_file():
        raise BagError(f"{parameters}: no such parameter file. Name one with --params-file.")
    nodes = [NODES[name](parameters) for name in node_names]
    present = {topic.name for topic in bag.facts.topics if topic.count}
    for node in nodes:
        _require_inputs(bag.path, node, present)
    outputs: list[Output] = []
    input_count = sum(_feed(messages, node, outputs) for node in nodes)
    outputs.sort(key=lambda each: each.stamp_ns)
    compared = sorted(topic for node in nodes for topic in node.compared)
    return Replay(
        tuple(outputs),
        tuple(_compare(topic, messages, outputs, tolerance_db) for topic in compared),
        input_count,
    )


def _require_inputs(path: Path, node: Replayed, present: Collection[str]) -> None:
    missing = sorted({each.topic for each in node.inputs} - {*present} - _MAY_BE_SILENT)
    if missing:
        raise BagError(
            f"{path}: holds nothing on {', '.join(missing)}, which {node.node_name} needs. Record "
            "with --all, from before the nodes start."
        )


def _feed(messages: list[BagMessage], node: Replayed, outputs: list[Output]) -> int:
    """Run one core through a bag, adding what it makes to `outputs`; returns the inputs it got."""

    def keep(now_ns: int, made: Any) -> None:
        outputs.extend(
            _output(topic, message, now_ns)
            for topic, message in node.messages(made, now_ns)
            if topic in node.compared
        )

    inputs = {each.topic: each for each in node.inputs}
    run = CoreRun(node.core, messages[0].stamp_ns, keep)
    count = 0
    for message in messages:
        run.advance(message.stamp_ns)
        found = inputs.get(message.topic)
        if found is not None:
            # What the node refused, its core refuses too.
            with contextlib.suppress(MessageError):
                record = found.decode(deserialize_message(message.data, found.kind))
                run.hand_over(found.take, record)
            count += 1
    return count


def _output(topic: str, message: Any, now_ns: int) -> Output:
    package, kind, _ = type(message).__module__.split(".")
    name = f"{package}/{kind}/{type(message).__name__}"
    # rclpy leaves garbage in the padding, so the fields are written anew.
    fields = _TYPES.deserialize_cdr(serialize_message(message), name)
    return Output(topic, name, now_ns, message, bytes(_TYPES.serialize_cdr(fields, name)))


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
