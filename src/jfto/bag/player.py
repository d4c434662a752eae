"""`bag play`: publishes the messages of a bag in their rhythm."""

from __future__ import annotations

import time
from dataclasses import dataclass, field
from typing import Any

from jfto.bag.qos import playing_profile
from jfto.bag.reader import Bag, BagMessage
from jfto.ros_cli.errors import RosCommandError
from jfto.ros_cli.interfaces import message_class
from jfto.ros_cli.session import Session

NODE_NAME = "rosbag2_player"
CLOCK = "/clock"
_DEPTH = 10
# Subscriptions that are there already are waited for so long: nobody misses the first messages.
_MATCH_LIMIT_S = 2.0
_ACKNOWLEDGE_LIMIT_S = 2.0


@dataclass(frozen=True)
class PlayOptions:
    """How a bag is played; `clock_hz` publishes /clock, `topics` empty means all."""

    rate: float = 1.0
    topics: frozenset[str] = frozenset()
    excluded: frozenset[str] = frozenset()
    remap: dict[str, str] = field(default_factory=dict)
    clock_hz: float | None = None
    start_offset_s: float = 0.0
    delay_s: float = 0.0
    loop: bool = False


class Player:
    """Publishers for the topics of a bag; `published` counts messages."""

    def __init__(self, session: Session, bag: Bag, options: PlayOptions) -> None:
        self.published = 0
        self._session = session
        self._bag = bag
        self._options = options
        self._publishers: dict[str, Any] = {}
        self._clock: Any = None
        self._make_publishers()

    def _make_publishers(self) -> None:
        node, options = self._session.node, self._options
        for topic in self._bag.facts.topics:
            if not self._is_chosen(topic.name):
                continue
            try:
                kind = message_class(topic.type_name)
            except RosCommandError as error:
                node.get_logger().warning(f"Ignoring a topic '{topic.name}', reason: {error}.")
                continue
            profile, agreed = playing_profile(list(topic.offered), _DEPTH)
            if not agreed:
                node.get_logger().warning(
                    f"Not all original publishers on topic {topic.name} offered the same QoS "
                    "profiles. Falling back to the default: reliable, volatile."
                )
            name = options.remap.get(topic.name, topic.name)
            self._publishers[topic.name] = node.create_publisher(kind, name, profile)
        if options.clock_hz is not None:
            self._clock = node.create_publisher(message_class("rosgraph_msgs/msg/Clock"), CLOCK, 10)

    def _is_chosen(self, topic: str) -> bool:
        options = self._options
        if topic in options.excluded or (options.clock_hz is not None and topic == CLOCK):
            return False
        return not options.topics or topic in options.topics

    def run(self) -> None:
        """Play to the end, or for ever with `loop`. Raises Stopped after a signal."""
        self._wait_for_subscriptions()
        self._session.node.get_logger().info(f"Set rate to {self._options.rate:g}")
        while True:
            self._wait_until(time.monotonic() + self._options.delay_s)
            self._play_once()
            if not self._options.loop or not self._publishers:
                break
        self._wait_for_acknowledgments()

    def _play_once(self) -> None:
        first_ns = self._bag.facts.start_ns + round(self._options.start_offset_s * 1e9)
        timeline = _Timeline(first_ns, self._options.rate)
        tick_ns = first_ns
        for message in self._bag.messages(self._publishers.keys()):
            # Latched messages from before the offset are not sent either, as in rosbag2.
            if message.stamp_ns < first_ns:
                continue
            if self._clock is not None:
                tick_ns = self._tick_until(message.stamp_ns, tick_ns, timeline)
            self._wait_until(timeline.due(message.stamp_ns))
            self._publish(message)

    def _publish(self, message: BagMessage) -> None:
        self._publishers[message.topic].publish(message.data)
        self.published += 1

    def _tick_until(self, stamp_ns: int, tick_ns: int, timeline: _Timeline) -> int:
        """Publish /clock on its own rhythm of wall time up to a message; the next tick's time."""
        from rclpy.time import Time
        from rosgraph_msgs.msg import Clock

        assert self._options.clock_hz is not None
        step_ns = max(round(1e9 * self._options.rate / self._options.clock_hz), 1)
        while tick_ns <= stamp_ns:
            self._wait_until(timeline.due(tick_ns))
            self._clock.publish(Clock(clock=Time(nanoseconds=tick_ns).to_msg()))
            tick_ns += step_ns
        return tick_ns

    def _wait_until(self, moment: float) -> None:
        self._session.spin_until(lambda: False, moment - time.monotonic())

    def _wait_for_subscriptions(self) -> None:
        node = self._session.node

        def matched() -> bool:
            return all(
                publisher.get_subscription_count() >= node.count_subscribers(publisher.topic_name)
                for publisher in self._publishers.values()
            )

        self._session.spin_until(matched, _MATCH_LIMIT_S)

    def _wait_for_acknowledgments(self) -> None:
        from rclpy.duration import Duration

        for publisher in self._publishers.values():
            publisher.wait_for_all_acked(Duration(seconds=_ACKNOWLEDGE_LIMIT_S))


class _Timeline:
    """From the bag's time to the monotonic clock's, s."""

    def __init__(self, first_ns: int, rate: float) -> None:
        self._first_ns, self._rate = first_ns, rate
        self._begin = time.monotonic()

    def due(self, stamp_ns: int) -> float:
        """When a message of a time is to be sent."""
        return self._begin + (stamp_ns - self._first_ns) / 1e9 / self._rate
