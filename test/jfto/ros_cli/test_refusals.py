"""What is refused before anything is done, and what the user reads."""

from __future__ import annotations

import click
import pytest

from jfto.cli.main import cli
from jfto.ros_cli.errors import RosCommandError
from jfto.ros_cli.interfaces import fill, read_yaml


def _run(session, *arguments):
    return cli.main(list(arguments), prog_name="jfto", standalone_mode=False, obj=session)


@pytest.mark.parametrize(
    "arguments",
    [
        ["topic", "echo", "--once", "/bad topic"],
        ["topic", "echo", "--once", "/bad//topic", "std_msgs/msg/String"],
        ["topic", "hz", "/bad-topic"],
        ["topic", "pub", "--once", "-w", "0", "/bad topic", "std_msgs/msg/String"],
        ["service", "call", "/bad service", "std_srvs/srv/Trigger"],
    ],
)
def test_names_that_cannot_be_are_named(arguments, session):
    """The words of rcl about the name, as an error of the command and not a crash."""
    with pytest.raises(RosCommandError, match=r"(?i)invalid"):
        _run(session, *arguments)


def test_topic_with_two_types_is_not_guessed(session, demo):
    """Echo says which types there are instead of taking one."""
    from std_msgs.msg import Bool, String

    publishers = [demo.create_publisher(kind, "/twofold", 10) for kind in (Bool, String)]
    try:
        assert session.spin_until(
            lambda: len(dict(session.node.get_topic_names_and_types()).get("/twofold", [])) == 2, 20
        )
        with pytest.raises(RosCommandError, match=r"std_msgs/msg/Bool, std_msgs/msg/String"):
            _run(session, "topic", "echo", "--once", "/twofold")
    finally:
        for publisher in publishers:
            demo.destroy_publisher(publisher)


def test_times_and_once_exclude_each_other(session):
    """Two ways to say how often are one too many."""
    with pytest.raises(click.UsageError):
        _run(session, "topic", "pub", "--once", "-t", "2", "/x", "std_msgs/msg/String")


def test_yaml_that_is_none_says_where(session):
    """The place of the fault is in the text."""
    with pytest.raises(RosCommandError, match="line 1, column 9"):
        read_yaml("{data: [}")


def test_stamps_that_are_now_take_the_time_of_sending():
    """`auto` headers and `now` stamps are filled when the message goes out, at any depth."""
    from builtin_interfaces.msg import Time
    from geometry_msgs.msg import PoseStamped
    from std_msgs.msg import Header

    message = PoseStamped()
    setters = fill(message, {"header": "auto", "pose": {"position": {"x": 1}}})
    for setter in setters:
        setter(Time(sec=5, nanosec=6))
    assert (message.header.stamp.sec, message.header.frame_id) == (5, "")
    header = Header()
    (setter,) = fill(header, {"stamp": "now", "frame_id": "map"})
    setter(Time(sec=7, nanosec=8))
    assert (header.stamp.sec, header.frame_id) == (7, "map")


def test_published_message_arrives(session, demo):
    """What `topic pub` says it has published is what the subscriber gets."""
    del demo.heard[:]
    _run(session, "topic", "pub", "--once", "/uav1/cmd", "std_msgs/msg/String", "{data: land}")
    assert session.spin_until(lambda: [each.data for each in demo.heard] == ["land"], 20)
