"""What a subscription gets of a burst, and QoS events."""

import pytest
import rclpy
from rclpy.event_handler import PublisherEventCallbacks, SubscriptionEventCallbacks
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.qos import QoSProfile
from std_msgs.msg import Bool, Int32, String

from rclpy_contract.environment import names, spin_for, spin_until, wait_until
from rclpy_contract.observations import RECORDED


@pytest.mark.parametrize("line", RECORDED["delivery"], ids=lambda line: line["did"])
def test_bursts(line):
    """Twenty messages while nobody spins: history, reliability and durability decide."""
    rclpy.init(args=[])
    node, executor = Node("n"), SingleThreadedExecutor()

    def burst(publisher_qos, subscription_qos, late=False):
        got = []
        publisher = node.create_publisher(Int32, "burst", publisher_qos)

        def subscribe():
            node.create_subscription(Int32, "burst", lambda m: got.append(m.data), subscription_qos)

        if not late:
            subscribe()
            assert wait_until(lambda: publisher.get_subscription_count() == 1)
        for number in range(20):
            publisher.publish(Int32(data=number))
        if late:
            subscribe()
            assert wait_until(lambda: publisher.get_subscription_count() == 1)
        executor.add_node(node)
        if line["saw"] != "[]":
            assert spin_until(executor, lambda: got and got[-1] == 19)
        spin_for(executor, 0.1)
        return got

    assert repr(eval(line["did"], names() | {"burst": burst})) == line["saw"]


def test_raw_and_message_info():
    """A raw subscription gets bytes; a callback of two arguments gets a dictionary too."""
    rclpy.init(args=[])
    node, executor, got = Node("n"), SingleThreadedExecutor(), {}
    executor.add_node(node)
    node.create_subscription(String, "a", lambda m: got.update(raw=m), 10, raw=True)
    node.create_subscription(String, "a", lambda m, info: got.update(pair=(m, info)), 10)
    publisher = node.create_publisher(String, "a", 10)
    assert wait_until(lambda: publisher.get_subscription_count() == 2)
    publisher.publish(String(data="ab"))
    assert spin_until(executor, lambda: len(got) == 2)
    message, info = got["pair"]
    shown = [("bytes", got["raw"]), (type(message).__name__, sorted(info))]
    assert repr(shown) == RECORDED["publishing"][18]["saw"]


def test_incompatible_qos_events():
    """Both sides hear of an incompatible policy, with own callbacks or as a warning."""
    rclpy.init(args=[])
    node, executor, events = Node("n"), SingleThreadedExecutor(), []
    executor.add_node(node)
    note = events.append
    node.create_publisher(
        String, "inc", 1, event_callbacks=PublisherEventCallbacks(incompatible_qos=note)
    )
    node.create_subscription(
        String,
        "inc",
        lambda _message: None,
        QoSProfile(depth=1, durability=1),
        event_callbacks=SubscriptionEventCallbacks(incompatible_qos=note),
    )
    assert spin_until(executor, lambda: len(events) == 2)
    for event in events:
        assert type(event).__name__ == "rmw_requested_qos_incompatible_event_status_t"
        assert (event.total_count, event.total_count_change) == (1, 1)
        assert event.last_policy_kind == 2


def test_incompatible_qos_warnings(capfd):
    """Without callbacks each side logs one line."""
    rclpy.init(args=[])
    node, executor = Node("n"), SingleThreadedExecutor()
    executor.add_node(node)
    node.create_publisher(String, "inc", QoSProfile(depth=1, reliability=2))
    node.create_subscription(String, "inc", lambda _message: None, 1)
    seen = []

    def both():
        seen.append(capfd.readouterr().err)
        return "".join(seen).count("Last incompatible policy: RELIABILITY") == 2

    assert spin_until(executor, both)
    text = "".join(seen)
    assert (
        "[n]: New publisher discovered on topic 'inc', offering incompatible QoS. "
        "No messages will be received from it. Last incompatible policy: RELIABILITY"
    ) in text
    assert (
        "[n]: New subscription discovered on topic 'inc', requesting incompatible QoS. "
        "No messages will be sent to it. Last incompatible policy: RELIABILITY"
    ) in text


def test_other_type_on_topic(capfd):
    """A publisher and a subscription of different types do not meet, silently."""
    rclpy.init(args=[])
    node, executor, events = Node("n"), SingleThreadedExecutor(), []
    executor.add_node(node)
    publisher = node.create_publisher(Bool, "inc4", 1)
    node.create_subscription(
        String,
        "inc4",
        lambda _message: None,
        1,
        event_callbacks=SubscriptionEventCallbacks(incompatible_type=events.append),
    )
    spin_for(executor, 0.1)
    assert capfd.readouterr().err == ""
    counts = (events, publisher.get_subscription_count(), node.count_subscribers("inc4"))
    assert repr(counts) == RECORDED["qos_incompatible"][1]["saw"]


def test_matched_events():
    """A subscription hears of publishers that come and go."""
    rclpy.init(args=[])
    node, executor, events = Node("n"), SingleThreadedExecutor(), []
    executor.add_node(node)

    def note(event):
        events.append(
            (
                event.total_count,
                event.total_count_change,
                event.current_count,
                event.current_count_change,
            )
        )

    node.create_subscription(
        String, "m", lambda _m: None, 1, event_callbacks=SubscriptionEventCallbacks(matched=note)
    )
    publisher = node.create_publisher(String, "m", 1)
    assert spin_until(executor, lambda: len(events) == 1)
    node.destroy_publisher(publisher)
    assert spin_until(executor, lambda: len(events) == 2)
    assert events == [(1, 1, 1, 1), (1, 0, 0, -1)]


def test_event_callback_containers():
    """The containers have the recorded members."""
    expected = eval(RECORDED["qos_incompatible"][3]["saw"])
    for container, members in zip(
        (SubscriptionEventCallbacks(), PublisherEventCallbacks()), expected, strict=True
    ):
        assert [name for name in dir(container) if not name.startswith("_")] == members
