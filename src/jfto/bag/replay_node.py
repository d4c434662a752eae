"""The real nodes with their edges replaced: no network, no clock, every output kept."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from types import SimpleNamespace
from typing import Any

from rclpy.context import Context
from rclpy.parameter import Parameter
from rclpy.serialization import serialize_message
from rosbags.typesys import Stores, get_typestore

from jfto.bag.errors import BagError
from jfto.bag.replay_clock import ReplayClock, ReplayTimer
from jfto_power.node.power_node import PowerNode
from jfto_topology.node.topology_node import TopologyNode

# Name for the command line: the node's class.
NODES = {"topology": TopologyNode, "power": PowerNode}
# Options of a node that would tie a replay to files of the run.
_LEFT_OUT = ("state_file",)
# A domain that no fleet uses: a process takes discovery settings once per domain, so that switching
# discovery off is not enough beside a node that is on the network.
_DOMAIN_ID = 231
_TYPES = get_typestore(Stores.ROS2_JAZZY)


@dataclass(frozen=True)
class Output:
    """What a node published, when, as the object and as bytes that only its fields decide."""

    topic: str
    type_name: str
    stamp_ns: int
    message: Any
    data: bytes


class ReplayEdges:
    """What a node reaches of the world: recorded inputs, the replay's clock, a list of outputs.

    Put in place of a node's own methods, once rclpy has made what it needs for itself.
    """

    def __init__(self, node: Any, clock: ReplayClock, outputs: list[Output]) -> None:
        self.node = node
        # Class of the messages, and what takes them, by topic.
        self.inputs: dict[str, tuple[Any, Callable[[Any], Any]]] = {}
        self.published: set[str] = set()
        self._clock = clock
        self._outputs = outputs
        node.now_ns = lambda: clock.now_ns
        node.create_subscription = self._subscribe
        node.create_publisher = node.create_lifecycle_publisher = self._announce
        node.create_timer = self._add_timer

    def _subscribe(self, kind: Any, topic: str, callback: Any, *_: Any, **__: Any) -> None:
        self.inputs[topic] = (kind, callback)

    def _announce(self, _kind: Any, topic: str, *_: Any, **__: Any) -> Any:
        self.published.add(topic)
        return SimpleNamespace(publish=partial(self._keep, topic))

    def _add_timer(
        self, period_s: float, callback: Callable[[], Any], *_: Any, **__: Any
    ) -> ReplayTimer:
        return self._clock.add_timer(round(period_s * 1e9), callback)

    def _keep(self, topic: str, message: Any) -> None:
        """Keep an output; a node that is not active has none."""
        if self.node.is_active:
            package, kind, _ = type(message).__module__.split(".")
            name = f"{package}/{kind}/{type(message).__name__}"
            # rclpy leaves garbage in the padding, so the fields are written anew.
            fields = _TYPES.deserialize_cdr(serialize_message(message), name)
            data = bytes(_TYPES.serialize_cdr(fields, name))
            self._outputs.append(Output(topic, name, self._clock.now_ns, message, data))


@contextlib.contextmanager
def replay_nodes(
    names: list[str], parameters: Path, clock: ReplayClock, outputs: list[Output]
) -> Iterator[list[ReplayEdges]]:
    """Edges of the nodes, active, off the network. Raises JftoError for unfit parameters."""
    if not parameters.is_file():
        raise BagError(f"{parameters}: no such parameter file. Name one with --params-file.")
    context = Context()
    nodes: list[Any] = []
    try:
        with _isolated():
            context.init(args=[], domain_id=_DOMAIN_ID)
        for name in names:
            nodes.append(_make_node(name, parameters, context))
        edges = [ReplayEdges(node, clock, outputs) for node in nodes]
        for node in nodes:
            # Recorded outputs are those of an active node, whoever had activated it.
            node.autostart = True
            node.start()
        yield edges
    finally:
        for node in nodes:
            node.destroy_node()
        context.try_shutdown()


def _make_node(name: str, parameters: Path, context: Context) -> Any:
    node: Any = NODES[name](
        context=context,
        cli_args=["--ros-args", "--params-file", str(parameters)],
        use_global_arguments=False,
        enable_rosout=False,
        start_parameter_services=False,
    )
    node.set_parameters(
        [Parameter(each, value="") for each in _LEFT_OUT if node.has_parameter(each)]
    )
    return node


@contextlib.contextmanager
def _isolated() -> Iterator[None]:
    """Keep a context that begins inside from finding anybody, and from being found."""
    key = "ROS_AUTOMATIC_DISCOVERY_RANGE"
    before = os.environ.get(key)
    os.environ[key] = "OFF"
    try:
        yield
    finally:
        if before is None:
            del os.environ[key]
        else:
            os.environ[key] = before
