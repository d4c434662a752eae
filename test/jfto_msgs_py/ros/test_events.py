"""Events through their message, and what keeps them from flooding anybody."""

from __future__ import annotations

import pytest
from rcl_interfaces.msg import Log

from jfto_msgs_py.errors import MessageError
from jfto_msgs_py.records.event import ERROR, INFO, WARN, Event
from jfto_msgs_py.ros import qos, topics
from jfto_msgs_py.ros.events import EventLimit, decode_event, encode_event
from jfto_topology.node.topology_node import TopologyNode
from support.graph import Graph


def test_an_event_survives_its_message() -> None:
    """Stamp, level, node, kind, UAV and text, in the fields that the contract names."""
    event = Event(WARN, "k_min", "uav3", "too few, told so", 1763776800_250000001, "topology_node")
    message = encode_event(event)
    assert (message.function, message.file, message.name) == ("k_min", "uav3", "topology_node")
    assert (message.level, message.msg) == (30, "too few, told so")
    assert decode_event(message) == event


@pytest.mark.parametrize(
    ("field", "value"),
    [("level", 25), ("function", ""), ("msg", ""), ("msg", "two\nlines")],
)
def test_a_message_that_is_no_event_is_refused(field, value) -> None:
    """Each field at fault is named."""
    message = encode_event(Event(INFO, "late", "", "text", 0, "node"))
    setattr(message, field, value)
    with pytest.raises(MessageError) as caught:
        decode_event(message)
    assert caught.value.field == field


def test_the_limit_lets_a_burst_through_then_a_trickle() -> None:
    """Ten at once, then one each two seconds, saying how many were held back; per kind and UAV."""
    now = [100.0]
    limit = EventLimit(lambda: now[0])
    assert [limit.admit("late", "uav1") for _ in range(12)] == [0] * 10 + [None, None]
    assert limit.admit("late", "uav2") == 0
    assert limit.admit("gps", "uav1") == 0
    now[0] += 2.0
    assert limit.admit("late", "uav1") == 2
    assert limit.admit("late", "uav1") is None
    now[0] += 1000.0
    assert [limit.admit("late", "uav1") for _ in range(11)] == [1] + [0] * 9 + [None]


def test_a_late_joiner_hears_what_a_node_has_announced() -> None:
    """In their order, with the node's name and clock; a flood of one kind hides no other."""
    with Graph() as graph:
        node = graph.add(TopologyNode, use_sim_time=True)
        graph.at(3.0)
        for number in range(20):
            node.announce(Event(WARN, "late", "uav1", f"{number} s late"))
        node.announce(Event(ERROR, "k_min", "", "the fleet is apart"))
        heard = graph.collect(Log, topics.EVENTS, qos.events())
        graph.until(lambda: len(heard) == 11)
        events = [decode_event(message) for message in heard]
    assert [event.text for event in events[:2]] == ["0 s late", "1 s late"]
    assert events[-1].text == "the fleet is apart"
    assert (events[-1].node, events[-1].kind, events[-1].level) == ("topology_node", "k_min", 40)
    assert events[-1].stamp_ns == 1_763_776_803 * 10**9
