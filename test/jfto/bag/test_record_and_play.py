"""Recording and playing, beside a node of this process."""

from __future__ import annotations

import signal
import subprocess
import sys
import threading
import time
from collections import Counter

import pytest
import yaml
from geometry_msgs.msg import PoseStamped
from nav_msgs.msg import Path as RosPath
from rclpy.parameter import Parameter
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy, qos_profile_sensor_data
from rosbags.interfaces import QosDurability
from rosgraph_msgs.msg import Clock
from std_msgs.msg import Float64MultiArray

from jfto.bag.player import Player, PlayOptions
from jfto.bag.reader import Bag
from jfto.cli.main import main
from jfto.ros_cli.session import open_session
from support.spinning import LIMIT_S, spinning_node, wait_until

LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)


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
    with spinning_node("tester") as node:
        yield node


@pytest.fixture
def talker(graph):
    """Publishes a latched path once, and poses 100 times a second."""
    graph.create_publisher(RosPath, "/uav1/plan", LATCHED).publish(RosPath())
    poses = graph.create_publisher(PoseStamped, "/uav1/pose", qos_profile_sensor_data)
    graph.sent_ns = []

    def publish():
        graph.sent_ns.append(time.time_ns())
        message = PoseStamped()
        message.pose.position.x = float(len(graph.sent_ns))
        poses.publish(message)

    graph.create_timer(0.01, publish)
    return graph


def _let_run(talker, count):
    before = len(talker.sent_ns)
    wait_until(lambda: len(talker.sent_ns) >= before + count)


def _is_kept_up(bag, on_disk) -> bool:
    """Whether the last pose on disk is fresh, and the one before it was until a second ago.

    `on_disk` holds when these poses were received, as they were found at each call.
    """
    last_ns = max((each.stamp_ns for each in Bag(bag).messages({"/uav1/pose"})), default=0)
    if last_ns > on_disk[-1]:
        on_disk.append(last_ns)
    fresh = time.time_ns() - last_ns < 10**9
    return fresh and len(on_disk) > 2 and on_disk[-1] - on_disk[-2] < 1.2 * 10**9


@pytest.mark.slow
def test_killed_recording_keeps_all_but_the_last_second(talker, tmp_path):
    """SIGKILL while messages come: all that is older than a second is there, QoS and all."""
    process = _start("record", "-o", tmp_path / "bag", "--all")
    log = _read_until(process, "'/uav1/pose'")
    _let_run(talker, 250)
    # A recorder that gets no time to run keeps nothing: it is killed while it gets some.
    on_disk = [0]
    wait_until(lambda: _is_kept_up(tmp_path / "bag", on_disk))
    process.kill()
    killed_ns = time.time_ns()
    process.wait(LIMIT_S)
    process.stderr.close()
    bag = Bag(tmp_path / "bag")
    assert "[rosbag2_recorder]: Subscribed to topic '/uav1/pose'" in log
    assert not bag.facts.complete
    counts = Counter(message.topic for message in bag.messages())
    assert counts["/uav1/plan"] == 1
    assert {topic.name: topic.offered[0].durability for topic in bag.facts.topics}[
        "/uav1/plan"
    ] is QosDurability.TRANSIENT_LOCAL
    stamps = [message.stamp_ns for message in bag.messages({"/uav1/pose"})]
    sent = [each for each in talker.sent_ns if stamps[0] <= each <= killed_ns - 10**9]
    # Best effort may lose one here and there; a second of them would be 100.
    assert len([each for each in stamps if each <= killed_ns - 10**9]) >= len(sent) - 10
    written = yaml.safe_load((tmp_path / "bag" / "metadata.yaml").read_text())
    topics = written["rosbag2_bagfile_information"]["topics_with_message_count"]
    assert "/uav1/pose" in {each["topic_metadata"]["name"] for each in topics}


@pytest.mark.slow
def test_interrupted_recording_is_a_complete_bag(talker, tmp_path):
    """SIGINT again and again ends with status 0 and an index; only what was named is in it."""
    process = _start("record", "-o", tmp_path / "bag", "/uav1/pose")
    _read_until(process, "All requested topics are subscribed")
    _let_run(talker, 50)
    end = time.monotonic() + LIMIT_S
    while process.poll() is None:
        assert time.monotonic() < end
        process.send_signal(signal.SIGINT)
        time.sleep(0.005)
    _, err = process.communicate(timeout=LIMIT_S)
    assert process.returncode == 0, err
    assert "Traceback" not in err
    facts = Bag(tmp_path / "bag").facts
    assert facts.complete
    assert [topic.name for topic in facts.topics] == ["/uav1/pose"]
    assert facts.message_count >= 10
    profile = facts.topics[0].offered[0]
    assert (profile.reliability.name, profile.depth) == ("BEST_EFFORT", 10)


@pytest.mark.slow
def test_parameters_of_nodes_are_kept_on_request(talker, tmp_path):
    """--parameters asks each node once; parameters without a value or empty are left out."""
    talker.declare_parameter("speed.cruise", 4.5)
    talker.declare_parameter("names", ["a", "b"])
    talker.declare_parameter("nobody", [""])
    talker.set_parameters([Parameter("nobody", Parameter.Type.STRING_ARRAY, [])])
    talker.declare_parameter("unset", Parameter.Type.STRING)
    process = _start("record", "-o", tmp_path / "bag", "/uav1/pose", "--parameters")
    wait_until((tmp_path / "bag" / "parameters.yaml").exists)
    process.send_signal(signal.SIGTERM)
    _, err = process.communicate(timeout=LIMIT_S)
    assert process.returncode == 0, err
    kept = yaml.safe_load((tmp_path / "bag" / "parameters.yaml").read_text())
    found = kept["/tester"]["ros__parameters"]
    assert (found["speed.cruise"], found["names"]) == (4.5, ["a", "b"])
    assert not {"unset", "nobody"} & set(found)


@pytest.mark.slow
def test_simulated_time_stamps_the_messages(talker, tmp_path):
    """--use-sim-time: nothing before /clock comes, then its time, also with a bag of that name."""
    (tmp_path / "bag").mkdir()
    process = _start("record", "-o", tmp_path / "bag", "--next-free", "-a", "--use-sim-time")
    _read_until(process, "Recording...")
    _let_run(talker, 20)
    clock = talker.create_publisher(Clock, "/clock", 10)
    seconds = iter(range(1000, 10**6))

    def tick():
        message = Clock()
        message.clock.sec = next(seconds)
        clock.publish(message)

    talker.create_timer(0.02, tick)
    _read_until(process, "'/uav1/pose'")
    _let_run(talker, 100)
    process.send_signal(signal.SIGINT)
    _, err = process.communicate(timeout=LIMIT_S)
    assert process.returncode == 0, err
    stamps = [each.stamp_ns for each in Bag(tmp_path / "bag-2").messages({"/uav1/pose"})]
    assert stamps == sorted(stamps)
    assert {stamp % 10**9 for stamp in stamps} == {0}
    # As many times as there were ticks: batches do not round them.
    assert len(set(stamps)) > len(stamps) / 10
    assert stamps[0] >= 1000 * 10**9
    assert stamps[-1] < next(seconds) * 10**9


def _play(bag, listened, **options):
    """Play when the subscriptions to the topics named have been found."""
    with open_session(node_name="player") as session:
        assert session.spin_until(
            lambda: all(session.node.count_subscribers(topic) for topic in listened), LIMIT_S
        )
        Player(session, Bag(bag), PlayOptions(**options)).run()


def test_playing_gives_every_message_with_its_qos(graph, bags):
    """Who listens before gets all reliable messages in order; renaming is obeyed."""
    poses, matrices, others = [], [], []
    graph.create_subscription(PoseStamped, "/uav1/pose", poses.append, 100)
    best_effort = QoSProfile(depth=100, reliability=ReliabilityPolicy.BEST_EFFORT)
    graph.create_subscription(PoseStamped, "/uav9/pose", others.append, best_effort)
    graph.create_subscription(Float64MultiArray, "/topology", matrices.append, LATCHED)
    topics = ("/uav1/pose", "/uav9/pose", "/topology")
    _play(bags / "jazzy_mcap_zstd", topics, rate=15.0, remap={"/uav2/pose": "/uav9/pose"})
    wait_until(lambda: len(poses) == 45 and others and matrices)
    # The bag begins while the fleet is in the air; from there on each step is one.
    xs = [pose.pose.position.x for pose in poses]
    assert xs == [xs[0] + index for index in range(45)]
    # Best effort and under another name; the fleet's second UAV flies 20 m north.
    assert {pose.pose.position.y for pose in others} == {20.0}
    assert [list(matrix.data) for matrix in matrices] == [[0.0, 1.0, 1.0, 0.0]]


def test_clock_is_the_time_of_the_bag(graph, bags):
    """Its own /clock replaces the recorded one, at the rate of the wall."""
    ticks = []
    graph.create_subscription(Clock, "/clock", ticks.append, 1000)
    _play(bags / "jazzy_mcap_zstd", ("/clock",), rate=5.0, clock_hz=100.0)
    wait_until(lambda: len(ticks) > 50)
    times = [tick.clock.sec + tick.clock.nanosec * 1e-9 for tick in ticks]
    assert times == sorted(times)
    # Times of the recording's receiver, not the simulated ones inside the recorded messages.
    assert all(1795316537 <= each <= 1795316542 for each in times)


@pytest.mark.slow
def test_late_joiner_gets_latched_topics_and_interrupt_is_no_failure(graph, bags):
    """A subscription made while the bag plays gets the topology; Ctrl-C ends with 0."""
    poses, matrices = [], []
    graph.create_subscription(PoseStamped, "/uav9/pose", poses.append, 100)
    process = _start("play", bags / "jazzy_mcap_zstd", "--loop", "--topics", "/topology",
                     "/uav1/pose", "/uav1/pose:=/uav9/pose")  # fmt: skip
    wait_until(lambda: len(poses) > 5)
    graph.create_subscription(Float64MultiArray, "/topology", matrices.append, LATCHED)
    wait_until(lambda: matrices)
    process.send_signal(signal.SIGINT)
    _, err = process.communicate(timeout=LIMIT_S)
    assert process.returncode == 0, err
    assert list(matrices[0].data) == [0.0, 1.0, 1.0, 0.0]


@pytest.mark.slow
def test_unknown_topic_plays_nothing_and_succeeds(bags):
    """As with ros2 bag, --topics of an unknown topic ends at once with 0."""
    process = _start("play", bags / "jazzy_mcap_zstd", "--topics", "/nope")
    _, err = process.communicate(timeout=LIMIT_S)
    assert process.returncode == 0, err


@pytest.mark.parametrize(
    ("arguments", "text"),
    [
        (["record"], "Name topics, or give --all or --regex."),
        (["record", "-o", ".", "-a"], "'.' is there already."),
        (["record", "-e", "["], "--regex"),
        (["record", "-a", "--parameters", "--params-file", "x"], "exclude each other"),
        (["record", "-a", "--params-file", "nope.yaml"], "nope.yaml: no such file"),
        (["play", "nope"], "Bag path 'nope' does not exist!"),
        (["play", "jazzy_mcap", "--rate", "0"], "--rate"),
        (["play", "jazzy_mcap", "--remap", "/a"], "is not OLD:=NEW"),
        (["play"], "Usage"),
    ],
)
def test_bad_arguments_are_refused_at_once(arguments, text, bags, capsys):
    """What is wrong is said before anything is begun, with the status of bad input."""
    assert main(["bag", *arguments]) == 2
    assert text in capsys.readouterr().err
