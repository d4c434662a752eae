"""`jfto bag info`."""

from __future__ import annotations

import pytest

from jfto.bag.contents import BagFacts, BagTopic, info_text
from jfto.cli.main import main


def test_facts_of_a_bag_of_ros2(bags, capsys):
    """Files, size, span and each topic with its type and count, laid out as ros2 bag does."""
    assert main(["bag", "info", "jazzy_sqlite3"]) == 0
    out, err = capsys.readouterr()
    lines = out.splitlines()
    assert "Files:             jazzy_sqlite3_0.db3" in lines
    assert "Storage id:        sqlite3" in lines
    assert "Messages:          353" in lines
    assert any(
        line.endswith(
            "Topic: /uav1/pose | Type: geometry_msgs/msg/PoseStamped | Count: 117 | "
            "Serialization Format: cdr"
        )
        for line in lines
    )
    assert err == ""


def test_recovered_bag_says_so(bags, capsys):
    """What was recovered is shown, and that it may not be all; topics alone are one a line."""
    assert main(["bag", "info", "split_sqlite3"]) == 0
    out, err = capsys.readouterr()
    assert "Messages:          30" in out
    assert "not finished" in err
    assert main(["bag", "info", "-t", "jazzy_mcap"]) == 0
    assert "/uav1/pose\n" in capsys.readouterr().out


def test_no_bag_is_an_error(bags, capsys):
    """A path that is not there is bad input."""
    assert main(["bag", "info", "nope"]) == 2
    assert "Bag path 'nope' does not exist!" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("size", "text"), [(0, "0 B"), (1023, "1023 B"), (2048, "2.0 KiB"), (5 << 20, "5.0 MiB")]
)
def test_service_events_are_no_topics(size, text):
    """Events of calls are counted as those of a service; sizes have the unit that fits."""
    topics = (
        BagTopic("/a", "std_msgs/msg/Empty", "cdr", (), 3),
        BagTopic("/go/_service_event", "std_srvs/srv/Trigger_Event", "cdr", (), 4),
    )
    shown = info_text(BagFacts(("a.mcap",), size, "mcap", "jazzy", 10**9, 2 * 10**9, topics))
    assert f"Bag size:          {text}\n" in shown
    assert "Messages:          3\n" in shown
    assert "Service: /go | Type: std_srvs/srv/Trigger | Events: 4" in shown
    assert "_service_event" not in shown
