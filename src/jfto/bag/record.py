"""`bag record`: a node that subscribes to topics as they appear and writes what comes."""

from __future__ import annotations

import re
import time
from dataclasses import dataclass
from functools import partial
from typing import Any

from jfto.bag.parameter_keeper import ParameterKeeper
from jfto.bag.qos import offered_by, recording_profile
from jfto.bag.recorder import BagRecorder
from jfto.ros_cli import graph_names
from jfto.ros_cli.interfaces import message_class
from jfto.ros_cli.session import Session, Stopped

NODE_NAME = "rosbag2_recorder"
_LOOK_EVERY_S = 0.1
# Half of the second that a kill may cost: the other half is for a machine under load.
_FLUSH_EVERY_S = 0.5
# More than rosbag2's 10: a pause for writing must not cost messages.
_DEPTH = 1000


@dataclass(frozen=True)
class Choice:
    """Which topics are recorded: those named, those that match, or all."""

    topics: tuple[str, ...] = ()
    pattern: re.Pattern[str] | None = None
    everything: bool = False
    hidden: bool = False
    excluded: tuple[str, ...] = ()

    def wants(self, topic: str) -> bool:
        """Whether a topic is to be recorded."""
        if topic in self.excluded:
            return False
        matches = self.pattern is not None and self.pattern.search(topic) is not None
        return topic in self.topics or self.everything or matches


class Recording:
    """Subscriptions that write to a bag."""

    def __init__(
        self,
        session: Session,
        recorder: BagRecorder,
        choice: Choice,
        keeper: ParameterKeeper | None = None,
    ) -> None:
        self._session = session
        self._keeper = keeper
        self._recorder = recorder
        self._choice = choice
        self._seen: set[str] = set()

    @property
    def complete(self) -> bool:
        """Whether all topics that were named are being recorded."""
        choice = self._choice
        open_ended = choice.everything or choice.pattern is not None
        return not open_ended and self._seen >= set(choice.topics)

    def look(self) -> None:
        """Subscribe to topics that have appeared, once there is a time to stamp messages with."""
        node = self._session.node
        if not node.get_clock().now().nanoseconds:
            return
        hidden = self._choice.hidden or bool(self._choice.topics)
        for topic, types in graph_names.topics(node, hidden=hidden):
            if topic not in self._seen and self._choice.wants(topic):
                publishers = node.get_publishers_info_by_topic(topic)
                # Only publishers tell the QoS; a topic without one has nothing to record yet.
                if publishers:
                    self._seen.add(topic)
                    self._subscribe(topic, types, publishers)

    def _subscribe(self, topic: str, types: list[str], publishers: list[Any]) -> None:
        node, log = self._session.node, self._session.node.get_logger()
        if len(types) > 1:
            log.warning(f"Topic '{topic}' has more than one type: {', '.join(types)}. Ignored.")
            return
        if not self._recorder.knows_type(types[0]):
            log.warning(f"Topic '{topic}' has unknown type '{types[0]}'. Ignored.")
            return
        self._recorder.add_topic(topic, types[0], offered_by(publishers))
        node.create_subscription(
            message_class(types[0]),
            topic,
            partial(self._write, topic),
            recording_profile(publishers, _DEPTH),
            raw=True,
        )
        log.info(f"Subscribed to topic '{topic}'")

    def _write(self, topic: str, data: bytes) -> None:
        now_ns = self._session.node.get_clock().now().nanoseconds
        self._recorder.write(topic, now_ns, bytes(data))

    def run(self) -> None:
        """Record until SIGINT or SIGTERM; the bag is left to be closed."""
        look = flush = time.monotonic()
        self._session.node.get_logger().info("Recording...")
        told = False
        try:
            while True:
                now = time.monotonic()
                if now >= look:
                    if not self.complete:
                        self.look()
                    if self._keeper is not None:
                        self._keeper.look()
                    look = now + _LOOK_EVERY_S
                if self.complete and not told:
                    self._session.node.get_logger().info("All requested topics are subscribed.")
                    told = True
                if now >= flush:
                    self._recorder.flush()
                    flush = now + _FLUSH_EVERY_S
                self._session.spin_once(max(min(look, flush) - time.monotonic(), 0.0))
        except Stopped:
            return
