"""`bag record`: a node that subscribes to topics as they appear and writes what comes."""

from __future__ import annotations

import time
from functools import partial
from typing import Any

from rclpy.qos import QoSProfile
from rclpy.serialization import deserialize_message
from rosgraph_msgs.msg import Clock

from jfto.bag.choice import Choice
from jfto.bag.parameter_keeper import ParameterKeeper
from jfto.bag.qos import offered_by
from jfto.bag.recorder import BagRecorder
from jfto.ros_cli import graph
from jfto.ros_cli.errors import RosCommandError
from jfto.ros_cli.messages import message_class, received_ns
from jfto.ros_cli.qos import fitting_profile
from jfto.ros_cli.session import Session, Stopped
from jfto_msgs_py.ros.stamps import decode_time

CLOCK = "/clock"
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
        keeper: ParameterKeeper | None = None,
        *,
        sim_time: bool = False,
    ) -> None:
        """With `sim_time` messages are stamped with /clock, and none is taken before it comes."""
        self._session = session
        self._recorder = recorder
        self._choice = choice
        self._keeper = keeper
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
            self._subscribe("", Clock, CLOCK, fitting_profile([], _DEPTH))
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
        if self._keeper is not None:
            self._keeper.look()
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
        for _ in range(self._keeper.go_on() if self._keeper is not None else 0):
            self._session.run_ready()
        self._batch.sort(key=lambda each: each[0])
        for stamp_ns, topic, data in self._batch:
            if not topic:
                self._sim_ns = decode_time(deserialize_message(data, Clock).clock)
            elif not self._sim_time or self._sim_ns:
                self._recorder.write(topic, self._sim_ns if self._sim_time else stamp_ns, data)
        self._batch.clear()
