"""What nodes know of each other, in one process and between two."""

import subprocess
import sys

import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from std_msgs.msg import String

from rclpy_contract.environment import names, spin_until, wait_until
from rclpy_contract.observations import RECORDED, agrees, attempt
from rclpy_contract.scripts import INIT, PRELUDE


def test_graph():
    """Names, types, counts and endpoint information, as recorded."""
    rclpy.init(args=[])
    # The recording had these nodes from earlier sections.
    others = [Node(name) for name in ("f", "g", "ls", "m")] + [Node("lc", namespace="/uav1")]
    a, b = Node("ga", namespace="/uav1"), Node("gb")
    publisher = a.create_publisher(String, "gt", 10)
    assert (a.count_publishers("gt"), publisher.get_subscription_count()) == (1, 0)
    assert sorted(b.get_node_names()) == ["f", "g", "ga", "gb", "lc", "ls", "m"]
    b.create_subscription(String, "/uav1/gt", lambda _message: None, 10)
    assert wait_until(lambda: publisher.get_subscription_count() == 1)
    environment = names() | {"a": a, "b": b}
    for number in range(2, 24):
        line = RECORDED["graph"][number]
        if number == 9:
            assert "/uav1/lc" in a.get_fully_qualified_node_names()
            continue
        came = attempt(line["did"], environment)
        if number == 11:
            # Both nodes of this test may subscribe to more than the recording's.
            assert ("/uav1/gt", ["std_msgs/msg/String"]) in eval(came)
            continue
        if number == 15:
            saw, shown = eval(line["saw"]), eval(came)
            gid = next(at for at, text in enumerate(saw) if text.startswith("GID"))
            assert saw[:gid] + saw[gid + 1 :] == shown[:gid] + shown[gid + 1 :]
            continue
        assert agrees(line["saw"], came), f"{number}: {line}\n{came}"
    assert len(others) == 5


def test_two_nodes_of_one_name():
    """Two nodes of one name are both listed; their services count twice."""
    rclpy.init(args=[])
    one, _two = Node("dup"), Node("dup")
    counts = (
        one.get_node_names().count("dup"),
        len([s for s in one.get_service_names_and_types() if s[0] == "/dup/get_parameters"]),
        one.count_services("/dup/get_parameters"),
    )
    assert repr(counts) == RECORDED["same_name"][0]["saw"]


_OTHER = """
node = rclpy.create_node("other", namespace="/far")
publisher = node.create_publisher(String, "there", 10)
node.create_service(Trigger, "serve", lambda request, response: response)
print("up", flush=True)
sys.stdin.readline()
node.destroy_node()
print("down", flush=True)
sys.stdin.readline()
"""


def test_other_process_comes_and_goes():
    """A node of another process is seen with all it has, and is gone when it is destroyed."""
    rclpy.init(args=[])
    node = Node("here")
    process = subprocess.Popen(
        [sys.executable, "-c", PRELUDE + INIT + _OTHER],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    )
    try:
        assert process.stdout.readline() == "up\n"
        assert node.wait_for_node("/far/other", 20.0)
        assert wait_until(lambda: node.count_publishers("/far/there") == 1)
        assert wait_until(lambda: node.count_services("/far/serve") == 1)
        assert ("/far/there", ["std_msgs/msg/String"]) in node.get_topic_names_and_types()
        process.stdin.write("\n")
        process.stdin.flush()
        assert process.stdout.readline() == "down\n"
        assert wait_until(lambda: node.count_publishers("/far/there") == 0)
        assert wait_until(lambda: "other" not in node.get_node_names())
    finally:
        process.communicate("\n", timeout=60)
    assert process.returncode == 0


def test_messages_between_processes():
    """A latched message reaches a subscription of another process."""
    rclpy.init(args=[])
    node, executor, got = Node("here"), SingleThreadedExecutor(), []
    executor.add_node(node)
    latched = names()["QoSProfile"](depth=1, durability=names()["TL"])
    node.create_subscription(String, "/latched", lambda message: got.append(message.data), latched)
    script = """
from rclpy.qos import QoSProfile
node = rclpy.create_node("talker")
publisher = node.create_publisher(String, "/latched", QoSProfile(depth=1, durability=1))
publisher.publish(String(data="kept"))
sys.stdin.readline()
"""
    process = subprocess.Popen(
        [sys.executable, "-c", PRELUDE + INIT + script], stdin=subprocess.PIPE, text=True
    )
    try:
        assert spin_until(executor, lambda: got)
        assert got == ["kept"]
    finally:
        process.communicate("\n", timeout=60)
