"""`bag record`: a node that subscribes to topics as they appear and writes what comes.

Beside the bag it may write all nodes' parameters, so that it can be replayed as it was flown.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import yaml
from rclpy.qos import QoSProfile
from rclpy.serialization import deserialize_message
from rosgraph_msgs.msg import Clock

from jfto.bag.qos import offered_by
from jfto.bag.recorder import PARAMETERS_NAME, BagRecorder, Choice
from jfto.ros_cli import RosCommandError, graph
from jfto.ros_cli.graph import fitting_profile
from jfto.ros_cli.messages import message_class, received_ns
from jfto.ros_cli.parameters import Steps, read_all
from jfto.ros_cli.session import Session, Stopped
from jfto_msgs_py.files import write_file
from jfto_msgs_py.ros import topics
from jfto_msgs_py.ros.stamps import decode_time

# Messages wait in the middleware and are taken by the batch: to wake up for each takes five times
# the processor time. When it was received comes with each. New topics are looked for as often.
_BATCH_EVERY_S = 0.1
# Half of the second that a kill may cost: the other half is for a machine under load.
_FLUSH_EVERY_S = 0.5
# More than rosbag2's 10: what comes between two batches must fit.
_DEPTH = 1000


class Recording:
    """Subscriptions that write to a bag."""

    def __init__(
        self,
        session: Session,
        recorder: BagRecorder,
        choice: Choice,
        parameters: ParametersFile | None = None,
        *,
        sim_time: bool = False,
    ) -> None:
        """With `sim_time` messages are stamped with /clock, and none is taken before it comes."""
        self._session = session
        self._recorder = recorder
        self._choice = choice
        self._parameters = parameters
        self._sim_time = sim_time
        self._sim_ns = 0
        self._known: set[str] = set()
        # By topic; that of the simulated time is "".
        self._subscriptions: dict[str, Any] = {}
        self._batch: list[tuple[int, str, bytes]] = []

    def run(self) -> None:
        """Record until SIGINT or SIGTERM; the bag is left to be closed."""
        node = self._session.node
        if self._sim_time:
            self._subscribe("", Clock, topics.CLOCK, fitting_profile([], _DEPTH))
        node.get_logger().info("Recording...")
        flush_s = 0.0
        try:
            while True:
                self._look()
                self._session.pause(_BATCH_EVERY_S)
                self._take_batch()
                if time.monotonic() >= flush_s:
                    self._recorder.flush()
                    flush_s = time.monotonic() + _FLUSH_EVERY_S
        except Stopped:
            self._take_batch()

    def _look(self) -> None:
        """Subscribe to topics that have appeared, once there is a time to stamp messages with."""
        node = self._session.node
        if self._parameters is not None:
            self._parameters.ask()
        if self._complete or (self._sim_time and not self._sim_ns):
            return
        # A hidden topic is recorded where it is named.
        for topic, types in graph.topics(node, hidden=bool(self._choice.topics)):
            if topic not in self._known and self._choice.wants(topic):
                publishers = node.get_publishers_info_by_topic(topic)
                # Only publishers tell the QoS; a topic without one has nothing to record yet.
                if publishers:
                    self._known.add(topic)
                    self._add_topic(topic, types, publishers)
        if self._complete:
            node.get_logger().info("All requested topics are subscribed.")

    @property
    def _complete(self) -> bool:
        """Whether all topics that were named are being recorded."""
        return not self._choice.is_open_ended and self._known >= self._choice.topics

    def _add_topic(self, topic: str, types: list[str], publishers: list[Any]) -> None:
        log = self._session.node.get_logger()
        try:
            if len(types) > 1:
                raise RosCommandError(f"it has several types: {', '.join(types)}.")
            kind = message_class(types[0])
        except RosCommandError as error:
            log.warning(f"Topic '{topic}' is not recorded: {error}")
            return
        self._recorder.add_topic(topic, types[0], offered_by(publishers))
        self._subscribe(topic, kind, topic, fitting_profile(publishers, _DEPTH))
        log.info(f"Subscribed to topic '{topic}'")

    def _subscribe(self, key: str, kind: Any, topic: str, profile: QoSProfile) -> None:
        self._subscriptions[key] = self._session.node.create_subscription(
            kind, topic, partial(self._put, key), profile, raw=True
        )

    def _put(self, topic: str, data: bytes, info: dict[str, Any]) -> None:
        self._batch.append((received_ns(info), topic, data))

    def _take_batch(self) -> None:
        """Write what has come since the last time, in the order in which it came."""
        for topic, subscription in self._subscriptions.items():
            for _ in range(_DEPTH):
                # As rclpy.wait_for_message does it: without a wait, whose cost grows with topics.
                taken = subscription.handle.take_message(subscription.msg_type, subscription.raw)
                if taken is None:
                    break
                self._put(topic, *taken)
        for _ in range(self._parameters.take_answers() if self._parameters is not None else 0):
            self._session.run_ready()
        self._batch.sort(key=lambda each: each[0])
        for stamp_ns, topic, data in self._batch:
            if not topic:
                self._sim_ns = decode_time(deserialize_message(data, Clock).clock)
            elif not self._sim_time or self._sim_ns:
                self._recorder.write(topic, self._sim_ns if self._sim_time else stamp_ns, data)
        self._batch.clear()


class ParametersFile:
    """Asks each node for its parameters once, as soon as it answers, and writes what it said."""

    def __init__(self, node: Any, path: Path) -> None:
        self._node = node
        self._file = path / PARAMETERS_NAME
        # What each node is being asked, and what is waited for before the next question.
        self._asking: dict[str, tuple[Steps[dict[str, Any]], Callable[[], bool]]] = {}
        self._trees: dict[str, Any] = {}

    def ask(self) -> None:
        """Begin to ask nodes that have appeared."""
        offered = dict(graph.services(self._node, hidden=True))
        for name in graph.nodes(self._node):
            known = name in self._asking or name in self._trees
            if not known and f"{name}/list_parameters" in offered:
                steps = read_all(self._node, name)
                self._asking[name] = (steps, next(steps))

    def take_answers(self) -> int:
        """Take answers in that have come, and ask on; how many are being waited for."""
        for name, (steps, came) in tuple(self._asking.items()):
            try:
                if came():
                    self._asking[name] = (steps, next(steps))
            except StopIteration as end:
                del self._asking[name]
                self._write(name, end.value)
        return len(self._asking)

    def _write(self, name: str, values: dict[str, Any]) -> None:
        # A parameter file cannot say of what type an empty list is.
        kept = {each: value for each, value in values.items() if value != []}
        self._trees[name] = {"ros__parameters": kept}
        write_file(self._file, yaml.safe_dump(self._trees))
