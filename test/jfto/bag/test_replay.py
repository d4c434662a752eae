"""A flight of ours, recorded live, through the nodes' cores again."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys

import pytest

from jfto.bag.contents import BagError
from jfto.bag.reader import Bag
from jfto.bag.recorder import BagRecorder
from jfto.bag.replay import replay_bag, write_outputs
from jfto.cli.main import main
from jfto_msgs_py.ros import topics

NODES = ["topology", "power"]


@pytest.fixture
def flight(bags):
    """The recorded flight."""
    return bags / "tiny_flight"


@pytest.mark.slow
def test_outputs_are_those_of_the_flight_and_bytes_repeat(flight, tmp_path):
    """Every link, interval, schedule and setpoint is the recorded one; twice the same bytes."""
    first = replay_bag(Bag(flight), NODES, flight / "parameters.yaml", 0.001)
    second = replay_bag(Bag(flight), NODES, flight / "parameters.yaml", 0.001)
    assert [problem for each in first.comparisons for problem in each.problems] == []
    compared = {each.topic: each.compared for each in first.comparisons}
    assert set(compared) == {
        topics.ADJACENCY, topics.POWER_INTERVAL, topics.POWER_SCHEDULE,
        *(topics.tx_power(f"uav{number}") for number in (1, 2, 3, 4)),
    }  # fmt: skip
    assert compared[topics.ADJACENCY] >= 10
    assert compared[topics.POWER_SCHEDULE] >= 10
    assert first.digest == second.digest
    for replay, folder in ((first, "one"), (second, "two")):
        write_outputs(replay, tmp_path / folder / "outputs")
    for name in ("outputs.mcap", "metadata.yaml"):
        one, two = (tmp_path / folder / "outputs" / name for folder in ("one", "two"))
        assert one.read_bytes() == two.read_bytes()


def test_pose_that_was_tampered_with_is_found(flight, tmp_path, capsys):
    """One UAV's poses moved 400 m away: the command names what differs and ends with 1."""
    from geometry_msgs.msg import PoseStamped
    from rclpy.serialization import deserialize_message, serialize_message

    source = Bag(flight)
    recorder = BagRecorder(tmp_path / "moved")
    for topic in source.facts.topics:
        recorder.add_topic(topic.name, topic.type_name, list(topic.offered))
    for message in source.messages():
        data = message.data
        if message.topic == topics.pose("uav2"):
            pose = deserialize_message(data, PoseStamped)
            pose.pose.position.x += 400.0
            data = bytes(serialize_message(pose))
        recorder.write(message.topic, message.stamp_ns, data)
    recorder.close()
    shutil.copy(flight / "parameters.yaml", tmp_path / "moved")
    assert main(["bag", "replay", str(tmp_path / "moved"), "--nodes", "topology"]) == 1
    out, err = capsys.readouterr()
    assert "✗ /jfto/topology/power_interval" in out
    assert "differs by" in err


def test_input_that_is_missing_is_named(flight, tmp_path):
    """A bag without trajectories cannot be replayed, and says why."""
    source = Bag(flight)
    recorder = BagRecorder(tmp_path / "bag")
    for topic in source.facts.topics:
        if not topic.name.endswith("trajectory"):
            recorder.add_topic(topic.name, topic.type_name, [])
    for message in source.messages():
        if not message.topic.endswith("trajectory"):
            recorder.write(message.topic, message.stamp_ns, message.data)
    recorder.close()
    with pytest.raises(BagError, match="/uav1/jfto/trajectory"):
        replay_bag(Bag(tmp_path / "bag"), NODES, flight / "parameters.yaml", 0.05)


def test_parameters_must_be_named(flight, tmp_path, capsys):
    """They lie beside the bag, or --params-file is asked for; an unknown node is refused."""
    shutil.copytree(flight, tmp_path / "bag")
    (tmp_path / "bag" / "parameters.yaml").unlink()
    assert main(["bag", "replay", str(tmp_path / "bag")]) == 2
    assert "--params-file" in capsys.readouterr().err
    file = flight / "tiny_flight.mcap"
    assert main(["bag", "replay", str(file), "--nodes", "topology"]) == 0
    assert main(["bag", "replay", str(flight), "--nodes", "planner"]) == 2
    assert "choose from topology, power" in capsys.readouterr().err


def test_energy_file_of_the_run_is_left_alone(flight, tmp_path):
    """A state_file among the parameters is neither written nor taken for the account."""
    energy = tmp_path / "energy.json"
    text = (flight / "parameters.yaml").read_text()
    text += f"\npower_node:\n  ros__parameters:\n    state_file: {energy}\n"
    (tmp_path / "parameters.yaml").write_text(text)
    replay = replay_bag(Bag(flight), ["power"], tmp_path / "parameters.yaml", 0.001)
    assert [problem for each in replay.comparisons for problem in each.problems] == []
    assert not energy.exists()


@pytest.mark.slow
def test_replay_never_reaches_the_network(flight):
    """A fleet that flies while a bag is replayed sees neither its nodes nor its outputs."""
    import threading

    import rclpy
    from rclpy.signals import SignalHandlerOptions
    from std_msgs.msg import UInt8MultiArray

    from jfto_msgs_py.ros import qos

    rclpy.init(args=[], signal_handler_options=SignalHandlerOptions.NO)
    node = rclpy.create_node("fleet")
    heard, seen, done = [], set(), threading.Event()
    node.create_subscription(UInt8MultiArray, topics.ADJACENCY, heard.append, qos.latched())

    def watch():
        while not done.is_set():
            seen.update(node.get_node_names())
            rclpy.spin_once(node, timeout_sec=0.02)

    thread = threading.Thread(target=watch)
    thread.start()
    try:
        assert replay_bag(Bag(flight), NODES, flight / "parameters.yaml", 0.05).outputs
    finally:
        done.set()
        thread.join(20)
        node.destroy_node()
        rclpy.try_shutdown()
    assert heard == []
    assert seen == {"fleet"}


@pytest.mark.slow
def test_bytes_do_not_depend_on_the_process(flight):
    """Another process, with other hashes of strings, gives the same digest."""
    outputs = [
        subprocess.run(
            [sys.executable, "-m", "jfto", "bag", "replay", str(flight)],
            env={**os.environ, "PYTHONHASHSEED": seed},
            capture_output=True,
            text=True,
            timeout=60,
            check=True,
        ).stdout
        for seed in ("1", "2")
    ]
    assert outputs[0] == outputs[1]
    assert "✗" not in outputs[0]
