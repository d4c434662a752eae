"""The real nodes with their edges replaced: no network, no clock, every output kept."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from jfto.bag.errors import BagError
from jfto.bag.replay_clock import ReplayClock, ReplayTimer
from jfto_msgs_py.ros.installation import require_ros

# Options of a node that would tie a replay to files of the run.
_LEFT_OUT = ("state_file",)
# A domain that no fleet uses: DDS takes discovery settings once per process and domain, so that
# switching discovery off is not enough beside a node that is on the network.
_DOMAIN_ID = 231


@dataclass(frozen=True)
class Output:
    """What a node published, when, as the object and as bytes."""

    node: str
    topic: str
    stamp_ns: int
    message: Any
    data: bytes


@dataclass(frozen=True)
class Input:
    """A subscription: the class of its messages and what takes them."""

    kind: Any
    callback: Callable[[Any], Any]


class _Publisher:
    """Keeps what is published while the node is active."""

    def __init__(self, owner: ReplayEdges, topic: str) -> None:
        self._owner, self._topic = owner, topic

    def publish(self, message: Any) -> None:
        self._owner.keep(self._topic, message)

    def get_subscription_count(self) -> int:
        return 0


class ReplayEdges:
    """Put before a node's class: its publishers, subscriptions and timers become ours."""

    # Until the node is whole, rclpy makes what it needs for itself.
    _edges_are_ours = False
    is_active: bool
    get_name: Callable[[], str]

    def take_edges(self, clock: ReplayClock, outputs: list[Output]) -> None:
        """From now on nothing reaches the network."""
        self.replay_clock = clock
        self.inputs: dict[str, Input] = {}
        self.published: set[str] = set()
        self._outputs = outputs
        self._edges_are_ours = True

    def now_ns(self) -> int:
        """Time of the replay."""
        return self.replay_clock.now_ns if self._edges_are_ours else 0

    def keep(self, topic: str, message: Any) -> None:
        """Keep an output; a node that is not active has none."""
        if self.is_active:
            from rclpy.serialization import serialize_message

            data = bytes(serialize_message(message))
            self._outputs.append(
                Output(self.get_name(), topic, self.replay_clock.now_ns, message, data)
            )

    def create_subscription(self, *arguments: Any, **options: Any) -> Any:
        """Keep the callback."""
        if not self._edges_are_ours:
            return super().create_subscription(*arguments, **options)  # type: ignore[misc]
        kind, topic, callback = arguments[:3]
        self.inputs[topic] = Input(kind, callback)
        return None

    def create_publisher(self, *arguments: Any, **options: Any) -> Any:
        """Publish into a list."""
        if not self._edges_are_ours:
            return super().create_publisher(*arguments, **options)  # type: ignore[misc]
        return self._publisher(arguments[1])

    def create_lifecycle_publisher(self, *arguments: Any, **options: Any) -> Any:
        """Publish into a list."""
        if not self._edges_are_ours:
            return super().create_lifecycle_publisher(*arguments, **options)  # type: ignore[misc]
        return self._publisher(arguments[1])

    def _publisher(self, topic: str) -> _Publisher:
        self.published.add(topic)
        return _Publisher(self, topic)

    def create_timer(self, *arguments: Any, **options: Any) -> Any:
        """Wait on the time of the replay."""
        if not self._edges_are_ours:
            return super().create_timer(*arguments, **options)  # type: ignore[misc]
        period_s, callback = arguments[:2]
        timer: ReplayTimer = self.replay_clock.add_timer(round(period_s * 1e9), callback)
        return timer


def _topology() -> Any:
    from jfto_topology.node.topology_node import TopologyNode

    return TopologyNode


def _power() -> Any:
    from jfto_power.power_node import PowerNode

    return PowerNode


# Name for the command line: how to get the node's class.
NODES: dict[str, Callable[[], Any]] = {"topology": _topology, "power": _power}


@contextlib.contextmanager
def replay_nodes(
    names: list[str], parameters: Path, clock: ReplayClock, outputs: list[Output]
) -> Iterator[list[Any]]:
    """The nodes, active, off the network. Raises JftoError for parameters that do not fit."""
    require_ros()
    from rclpy.context import Context
    from rclpy.parameter import Parameter

    if not parameters.is_file():
        raise BagError(f"{parameters}: no such parameter file. Name one with --params-file.")
    with _isolated():
        context = Context()
        context.init(args=[], domain_id=_DOMAIN_ID)
        nodes: list[Any] = []
        try:
            for name in names:
                kind = NODES[name]()
                node = type(f"Replayed{kind.__name__}", (ReplayEdges, kind), {})(
                    context=context,
                    cli_args=["--ros-args", "--params-file", str(parameters)],
                    use_global_arguments=False,
                    enable_rosout=False,
                    start_parameter_services=False,
                )
                nodes.append(node)
                for each in _LEFT_OUT:
                    if node.has_parameter(each):
                        (result,) = node.set_parameters([Parameter(each, value="")])
                        if not result.successful:
                            raise BagError(f"{parameters}: {each}: {result.reason}")
                node.take_edges(clock, outputs)
                # Recorded outputs are those of an active node, whoever had activated it.
                node.autostart = True
                node.start()
            yield nodes
        finally:
            for node in nodes:
                node.destroy_node()
            context.try_shutdown()


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
