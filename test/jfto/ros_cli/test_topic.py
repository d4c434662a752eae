"""`jfto topic` beside a real node."""

from __future__ import annotations

import click
import pytest
import yaml
from std_msgs.msg import Bool, String

from jfto.ros_cli import RosCommandError, graph
from jfto.ros_cli.topic_verbs import rate_text
from support.spinning import LIMIT_S, wait_until


def test_list_names_topics_and_types(run):
    """Names one a line and sorted; -t adds types, -c counts, -a shows hidden ones."""
    _, out = run("topic", "list")
    names = out.splitlines()
    assert {"/uav1/pose", "/uav1/matrix", "/uav1/goal"} <= set(names)
    assert names == sorted(names)
    assert "/uav1/pose [geometry_msgs/msg/PoseStamped]" in run("topic", "list", "-t")[1]
    assert run("topic", "list", "-c")[1] == f"{len(names)}\n"


def test_info_counts_both_ends(run):
    """Type, publishers and subscriptions; -v has the nodes and their QoS."""
    _, out = run("topic", "info", "/uav1/matrix")
    assert out == (
        "Type: std_msgs/msg/Float64MultiArray\nPublisher count: 1\nSubscription count: 0\n"
    )
    _, out = run("topic", "info", "-v", "/uav1/matrix")
    assert "Node name: demo" in out
    assert "Durability: TRANSIENT_LOCAL" in out


def test_echo_once_prints_one_yaml_document(run):
    """The message as YAML and ---, with all fields; a best-effort topic needs no options."""
    status, out = run("topic", "echo", "--once", "/uav1/pose")
    (document,) = [each for each in out.split("---\n") if each]
    message = yaml.safe_load(document)
    assert status == 0
    assert message["header"] == {"stamp": {"sec": 0, "nanosec": 0}, "frame_id": "map"}
    assert message["pose"]["position"] == {"x": 1.5, "y": 0.0, "z": 0.0}


def test_echo_shows_a_latched_topic_at_once(run):
    """What was published before is printed: the durability fits the publisher's."""
    assert yaml.safe_load(run("topic", "echo", "--once", "/uav1/matrix")[1].split("---")[0]) == {
        "layout": {"dim": [], "data_offset": 0},
        "data": [1.0, 2.5, float("inf")],
    }


@pytest.mark.parametrize(
    ("options", "text"),
    [
        (["--field", "data"], "- 1.0\n- 2.5\n- .inf\n---\n"),
        (["--field", "data", "-l", "1"], "- 1.0\n- '...'\n---\n"),
        (["--field", "layout.data_offset"], "0\n---\n"),
        (["--no-arr"], "data: '<sequence<double>, length: 3>'\n---\n"),
    ],
)
def test_echo_leaves_out_what_is_asked(options, text, run):
    """One field; arrays cut, or named only."""
    assert run("topic", "echo", "--once", "/uav1/matrix", *options)[1].endswith(text)


def test_echo_prints_texts_and_bytes(run):
    """Texts stay as they are, also those that YAML has to quote; a byte is a number."""
    out = run("topic", "echo", "--once", "/uav1/status", "std_msgs/msg/String")[1]
    assert out == "data: 'héllo \"q\" #1: yes'\n---\n"
    assert run("topic", "echo", "--once", "--no-str", "/uav1/status")[1] == (
        "data: '<string, length: 17>'\n---\n"
    )
    assert run("topic", "echo", "--once", "/uav1/level")[1].startswith("level: 2\nname: link\n")


def test_echo_obeys_a_quality_of_service_that_is_named(run):
    """Reliable does not match a best-effort publisher: nothing comes until the time-out."""
    options = ("--timeout", "0.5", "--qos-reliability", "reliable")
    assert run("topic", "echo", "/uav1/pose", *options) == (0, "")


def test_rate_is_that_of_the_intervals():
    """Mean, extremes and spread of the intervals between messages, in s."""
    assert rate_text([0, 10**8, 3 * 10**8]) == (
        "average rate: 6.667\n\tmin: 0.100s max: 0.200s std dev: 0.05000s window: 2"
    )


def test_published_message_arrives(run, demo):
    """`pub --once` waits for the subscription; `auto` and plain numbers are understood."""
    del demo.came[:]
    values = "{header: auto, pose: {position: {x: 3}}}"
    status, out = run(
        "topic", "pub", "--once", "/uav1/goal", "geometry_msgs/msg/PoseStamped", values
    )
    wait_until(lambda: demo.came)
    assert status == 0
    assert "publishing #1: geometry_msgs.msg.PoseStamped(" in out
    assert demo.came[0].pose.position.x == 3.0
    assert demo.came[0].header.stamp.sec > 0


@pytest.mark.parametrize(
    ("arguments", "text"),
    [
        (["topic", "echo", "/bad topic"], "(?i)invalid"),
        (["topic", "echo", "/bad//topic", "std_msgs/msg/String"], "(?i)invalid"),
        (["topic", "echo", "/x", "std_msgs/msg/Strin"], "No type 'std_msgs/msg/Strin'"),
        (["topic", "echo", "/x", "nope_msgs/msg/String"], "No type 'nope_msgs/msg/String'"),
        (["topic", "echo", "/uav1/pose", "--field", "pose.nope"], "--field pose.nope"),
        (["topic", "pub", "--once", "/x", "std_msgs/msg/String", "{data: [}"], "line 1, column 9"),
        (["topic", "pub", "--once", "/x", "std_msgs/msg/String", "3"], "must be fields"),
        (["topic", "pub", "--once", "/x", "std_msgs/msg/String", "{dat: x}"], "no field 'dat'"),
        (["topic", "pub", "--once", "/x", "std_msgs/msg/String", "{data: 3}"], "String.data"),
        (["topic", "pub", "--once", "/x", "std_msgs/msg/UInt8", "{data: 256}"], "cannot be 256"),
        (["node", "info", "/bad"], "No node /bad"),
        (["param", "get", "/bad", "x"], "No node /bad"),
        (["topic", "info", "/bad"], "No topic /bad"),
        (["service", "call", "/bad service", "std_srvs/srv/Trigger"], "(?i)invalid"),
        (
            ["service", "call", "/uav1/arm", "std_srvs/srv/Trigger"],
            "is of type std_srvs/srv/SetBool",
        ),
        (["service", "call", "/uav1/arm", "std_srvs/srv/Nope"], "No type 'std_srvs/srv/Nope'"),
    ],
)
def test_what_cannot_be_is_named(arguments, text, run, monkeypatch):
    """An error of the command that says what is wrong, not a crash."""
    monkeypatch.setattr(graph, "_APPEAR_LIMIT_S", 0.3)
    with pytest.raises(RosCommandError, match=text):
        run(*arguments)


def test_topic_with_two_types_is_not_guessed(run, session, demo):
    """Echo says which types there are instead of taking one."""
    publishers = [demo.create_publisher(String, "/twofold", 10)]
    with_other_type = session.node.create_publisher(Bool, "/twofold", 10)
    try:
        assert session.spin_until(
            lambda: len(dict(session.node.get_topic_names_and_types()).get("/twofold", [])) == 2,
            LIMIT_S,
        )
        with pytest.raises(RosCommandError, match=r"std_msgs/msg/Bool, std_msgs/msg/String"):
            run("topic", "echo", "--once", "/twofold")
    finally:
        session.node.destroy_publisher(with_other_type)
        demo.destroy_publisher(publishers[0])


def test_times_and_once_exclude_each_other(run):
    """Two ways to say how often are one too many."""
    with pytest.raises(click.UsageError):
        run("topic", "pub", "--once", "-t", "2", "/x", "std_msgs/msg/String")
