"""Recording and playing between processes."""

from __future__ import annotations

import signal
import subprocess
import sys
import threading
import time
from collections import Counter

import pytest

from jfto.bag.reader import Bag

LIMIT_S = 30.0


def _start(*arguments):
    return subprocess.Popen(
        [sys.executable, "-X", "faulthandler", "-m", "jfto", "bag", *map(str, arguments)],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
    )


def _read_until(process, text):
    watchdog = threading.Timer(LIMIT_S, process.send_signal, [signal.SIGABRT])
    watchdog.start()
    lines = []
    for line in process.stderr:
        lines.append(line)
        if text in line:
            break
    watchdog.cancel()
    return "".join(lines)


@pytest.fixture
def graph():
    """A spinning node of this process."""
    import rclpy
    from rclpy.executors import SingleThreadedExecutor
    from rclpy.signals import SignalHandlerOptions

    rclpy.init(args=[], signal_handler_options=SignalHandlerOptions.NO)
    node = rclpy.create_node("tester")
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    thread = threading.Thread(target=executor.spin)
    thread.start()
    yield node
    executor.shutdown()
    thread.join(LIMIT_S)
    node.destroy_node()
    rclpy.try_shutdown()
    assert not thread.is_alive()


@pytest.fixture
def talker(graph):
    """Publishes a latched path once, and poses 100 times a second."""
    from geometry_msgs.msg import PoseStamped
    from nav_msgs.msg import Path
    from rclpy.qos import DurabilityPolicy, QoSProfile, qos_profile_sensor_data

    latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    graph.create_publisher(Path, "/uav1/plan", latched).publish(Path())
    poses = graph.create_publisher(PoseStamped, "/uav1/pose", qos_profile_sensor_data)
    graph.sent_ns = []

    def publish():
        graph.sent_ns.append(time.time_ns())
        message = PoseStamped()
        message.pose.position.x = float(len(graph.sent_ns))
        poses.publish(message)

    graph.create_timer(0.01, publish)
    return graph


def _wait(condition):
    tick, end = threading.Event(), time.monotonic() + LIMIT_S
    while not condition():
        assert time.monotonic() < end
        tick.wait(0.01)


def test_killed_recording_keeps_all_but_the_last_second(talker, tmp_path):
    """SIGKILL while messages come: all that is older than a second is there, QoS and all."""
    process = _start("record", "-o", tmp_path / "bag", "--all")
    log = _read_until(process, "'/uav1/pose'")
    count = len(talker.sent_ns)
    _wait(lambda: len(talker.sent_ns) > count + 250)
    process.kill()
    killed_ns = time.time_ns()
    process.wait(LIMIT_S)
    process.stderr.close()
    bag = Bag(tmp_path / "bag")
    assert "[rosbag2_recorder]: Subscribed to topic '/uav1/pose'" in log
    assert not bag.facts.complete
    counts = Counter(message.topic for message in bag.messages())
    assert counts["/uav1/plan"] == 1
    stamps = [message.stamp_ns for message in bag.messages({"/uav1/pose"})]
    expected = [sent for sent in talker.sent_ns if stamps[0] <= sent <= killed_ns - 10**9]
    assert len([stamp for stamp in stamps if stamp <= killed_ns - 10**9]) >= len(expected) - 1
    assert (tmp_path / "bag" / "metadata.yaml").exists()


def test_interrupted_recording_is_a_complete_bag(talker, tmp_path):
    """SIGINT ends with status 0 and an index; only the topics named are in it."""
    process = _start("record", "-o", tmp_path / "bag", "/uav1/pose")
    _read_until(process, "All requested topics are subscribed")
    count = len(talker.sent_ns)
    _wait(lambda: len(talker.sent_ns) > count + 50)
    process.send_signal(signal.SIGINT)
    _, err = process.communicate(timeout=LIMIT_S)
    assert process.returncode == 0, err
    facts = Bag(tmp_path / "bag").facts
    assert facts.complete
    assert [topic.name for topic in facts.topics] == ["/uav1/pose"]
    assert facts.message_count >= 50
    profile = facts.topics[0].offered[0]
    assert (profile.reliability.name, profile.depth) == ("BEST_EFFORT", 5)


def test_parameters_of_nodes_are_kept_on_request(talker, tmp_path):
    """--parameters asks each node once; parameters without a value or empty are left out."""
    import yaml
    from rclpy.parameter import Parameter

    talker.declare_parameter("speed.cruise", 4.5)
    talker.declare_parameter("names", ["a", "b"])
    talker.declare_parameter("unset", Parameter.Type.STRING)
    process = _start("record", "-o", tmp_path / "bag", "/uav1/pose", "--parameters")
    _wait((tmp_path / "bag" / "parameters.yaml").exists)
    process.send_signal(signal.SIGTERM)
    _, err = process.communicate(timeout=LIMIT_S)
    assert process.returncode == 0, err
    kept = yaml.safe_load((tmp_path / "bag" / "parameters.yaml").read_text())
    found = kept["/tester"]["ros__parameters"]
    assert (found["speed.cruise"], found["names"]) == (4.5, ["a", "b"])
    assert "unset" not in found


def test_playing_gives_every_message_with_its_qos(graph, bags):
    """Who listens before gets all reliable messages in order; --remap is obeyed."""
    from geometry_msgs.msg import PoseStamped
    from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
    from std_msgs.msg import Float64MultiArray

    latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    poses, matrices, others = [], [], []
    graph.create_subscription(PoseStamped, "/uav1/pose", poses.append, 100)
    best_effort = QoSProfile(depth=100, reliability=ReliabilityPolicy.BEST_EFFORT)
    graph.create_subscription(PoseStamped, "/uav9/pose", others.append, best_effort)
    graph.create_subscription(Float64MultiArray, "/topology", matrices.append, latched)
    process = _start("play", bags / "jazzy_mcap_zstd", "--rate", "15", "/uav2/pose:=/uav9/pose")
    _, err = process.communicate(timeout=LIMIT_S)
    assert process.returncode == 0, err
    _wait(lambda: len(poses) == 45)
    # The bag begins while the fleet is in the air; from there on each step is one.
    xs = [pose.pose.position.x for pose in poses]
    assert xs == [xs[0] + index for index in range(45)]
    # Best effort and under another name; the fleet's second UAV flies 20 m north.
    assert {pose.pose.position.y for pose in others} == {20.0}
    assert [list(matrix.data) for matrix in matrices] == [[0.0, 1.0, 1.0, 0.0]]


def test_late_joiner_gets_latched_topics_and_interrupt_is_no_failure(graph, bags):
    """A subscription made while the bag plays gets the topology; Ctrl-C ends with 0."""
    from geometry_msgs.msg import PoseStamped
    from rclpy.qos import DurabilityPolicy, QoSProfile
    from std_msgs.msg import Float64MultiArray

    poses, matrices = [], []
    graph.create_subscription(PoseStamped, "/uav1/pose", poses.append, 100)
    process = _start("play", bags / "jazzy_mcap_zstd", "--loop")
    _wait(lambda: len(poses) > 5)
    latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    graph.create_subscription(Float64MultiArray, "/topology", matrices.append, latched)
    _wait(lambda: matrices)
    process.send_signal(signal.SIGINT)
    _, err = process.communicate(timeout=LIMIT_S)
    assert process.returncode == 0, err
    assert list(matrices[0].data) == [0.0, 1.0, 1.0, 0.0]


def test_clock_option_publishes_the_time_of_the_bag(graph, bags):
    """--clock replaces the recorded /clock; --topics leaves the others out."""
    from rclpy.qos import qos_profile_sensor_data
    from rosgraph_msgs.msg import Clock

    ticks = []
    graph.create_subscription(Clock, "/clock", ticks.append, qos_profile_sensor_data)
    process = _start("play", bags / "jazzy_mcap_zstd", "-r", "20", "--clock", "100",
                     "--topics", "/uav1/plan", "/uav2/pose")  # fmt: skip
    _, err = process.communicate(timeout=LIMIT_S)
    assert process.returncode == 0, err
    _wait(lambda: len(ticks) > 10)
    times = [tick.clock.sec + tick.clock.nanosec * 1e-9 for tick in ticks]
    # Times of the recording's receiver, not the simulated ones inside the recorded messages.
    assert times == sorted(times)
    assert all(1795316537 <= each <= 1795316542 for each in times)


def test_unknown_topic_plays_nothing_and_succeeds(bags):
    """As with ros2 bag, --topics of an unknown topic ends at once with 0."""
    process = _start("play", bags / "jazzy_mcap_zstd", "--topics", "/nope")
    _, err = process.communicate(timeout=LIMIT_S)
    assert process.returncode == 0, err


@pytest.mark.parametrize(
    ("arguments", "status", "text"),
    [
        (["record"], 1, "Need to specify at least one option"),
        (["record", "-o", ".", "-a"], 1, "[ERROR] [ros2bag]: Output folder '.' already exists."),
        (["play", "nope"], 2, "Bag path 'nope' does not exist!"),
        (["play", "jazzy_mcap", "--rate", "0"], 2, "--rate"),
        (["play"], 2, "Usage"),
    ],
)
def test_bad_arguments_are_refused_at_once(arguments, status, text, bags, capsys):
    """Status and words of ros2 bag."""
    from jfto.cli.main import main

    assert main(["bag", *arguments]) == status
    assert text in capsys.readouterr().err
