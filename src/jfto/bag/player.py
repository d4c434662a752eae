"""`bag play`: publishes the messages of a bag in their rhythm."""

from __future__ import annotations

import time
from dataclasses import dataclass, field
from typing import Any

from rclpy.duration import Duration
from rosgraph_msgs.msg import Clock

from jfto.bag.contents import BagTopic
from jfto.bag.qos import playing_profile
from jfto.bag.reader import Bag
from jfto.ros_cli import RosCommandError
from jfto.ros_cli.messages import message_class
from jfto.ros_cli.session import Session
from jfto_msgs_py.ros import topics
from jfto_msgs_py.ros.stamps import encode_time

# Subscriptions that are there already are waited for so long: nobody misses the first messages.
_MATCH_LIMIT_S = 2.0
_ACKNOWLEDGE_LIMIT_S = 2.0


@dataclass(frozen=True)
class PlayOptions:
    """How a bag is played; `clock_hz` publishes /clock, `topics` empty means all."""

    rate: float = 1.0
    topics: frozenset[str] = frozenset()
    remap: dict[str, str] = field(default_factory=dict)
    clock_hz: float | None = None
    start_offset_s: float = 0.0
    loop: bool = False


class Player:
    """Publishers for the topics of a bag."""

    def __init__(self, session: Session, bag: Bag, options: PlayOptions) -> None:
        self._session = session
        self._bag = bag
        self._options = options
        # By recorded topic; that of the clock which we are is "".
        self._publishers: dict[str, Any] = {}
        for topic in bag.facts.topics:
            replaced = options.clock_hz is not None and topic.name == topics.CLOCK
            if not replaced and (not options.topics or topic.name in options.topics):
                self._add(topic)
        if options.clock_hz is not None:
            self._publishers[""] = session.node.create_publisher(Clock, topics.CLOCK, 10)

    def _add(self, topic: BagTopic) -> None:
        node, log = self._session.node, self._session.node.get_logger()
        try:
            kind = message_class(topic.type_name)
        except RosCommandError as error:
            log.warning(f"Topic '{topic.name}' is not played: {error}")
            return
        profile, agreed = playing_profile(topic.offered)
        if not agreed:
            log.warning(
                f"The publishers of {topic.name} offered different QoS profiles, so it is played "
                "reliable and volatile."
            )
        name = self._options.remap.get(topic.name, topic.name)
        self._publishers[topic.name] = node.create_publisher(kind, name, profile)

    def run(self) -> None:
        """Play to the end, or for ever with `loop`. Raises Stopped after a signal."""
        self._session.spin_until(self._is_matched, _MATCH_LIMIT_S)
        self._play_once()
        while self._options.loop and self._publishers:
            self._play_once()
        end = time.monotonic() + _ACKNOWLEDGE_LIMIT_S
        for publisher in self._publishers.values():
            publisher.wait_for_all_acked(Duration(seconds=max(end - time.monotonic(), 0.0)))

    def _is_matched(self) -> bool:
        """Whether all subscriptions that are known of are connected."""
        node = self._session.node
        return all(
            publisher.get_subscription_count() >= node.count_subscribers(publisher.topic_name)
            for publisher in self._publishers.values()
        )

    def _play_once(self) -> None:
        options = self._options
        first_ns = self._bag.facts.start_ns + round(options.start_offset_s * 1e9)
        begin_s = time.monotonic()
        step_ns = max(round(1e9 * options.rate / (options.clock_hz or 1.0)), 1)
        tick_ns = first_ns

        def wait_for(stamp_ns: int) -> None:
            due_s = begin_s + (stamp_ns - first_ns) / 1e9 / options.rate
            self._session.pause(due_s - time.monotonic())

        for message in self._bag.messages(self._publishers.keys()):
            # Latched messages from before the offset are not sent either, as in rosbag2.
            if message.stamp_ns < first_ns:
                continue
            while options.clock_hz is not None and tick_ns <= message.stamp_ns:
                wait_for(tick_ns)
                self._publishers[""].publish(Clock(clock=encode_time(tick_ns)))
                tick_ns += step_ns
            wait_for(message.stamp_ns)
            self._publishers[message.topic].publish(message.data)
