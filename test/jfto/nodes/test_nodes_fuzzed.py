"""Topology and power nodes under messages whose bytes were tampered with."""

from __future__ import annotations

import os
import random

import numpy as np
import pytest
from geometry_msgs.msg import PoseStamped
from rclpy._rclpy_pybind11 import RCLError
from rclpy.serialization import serialize_message
from std_msgs.msg import Float64MultiArray, UInt8MultiArray
from trajectory_msgs.msg import MultiDOFJointTrajectory

from jfto_msgs_py.records.network import Adjacency, PowerIntervals, SlotHorizon
from jfto_msgs_py.ros import qos, topics
from jfto_msgs_py.ros.network import encode_adjacency, encode_power_intervals
from jfto_msgs_py.ros.vehicle import encode_pose, encode_trajectory
from jfto_power.node.power_node import PowerNode
from jfto_topology.node.topology_node import TopologyNode
from support.fleets import at, eastward, pose
from support.graph import Graph

IDS = ("uav1", "uav2", "uav3")
# JFTO_FUZZED=10000 tries more of them.
COUNT = int(os.environ.get("JFTO_FUZZED", "1500"))
WORDS = (b"\xff\xff\xff\xff", b"\x00\x00\x00\x7f", b"\x00\x00\x00\x00", b"9999")


def _good_messages() -> dict:
    horizon = SlotHorizon(0, at(0.0), 2.0, 4)
    links = np.zeros((4, 3, 3), dtype=bool)
    links[:, [0, 1, 1, 2], [1, 0, 2, 1]] = True
    bounds = np.broadcast_to([0.01, 1.0], (4, 3, 2)).copy()
    messages = {
        topics.ADJACENCY: encode_adjacency(Adjacency(horizon, IDS, links)),
        topics.POWER_INTERVAL: encode_power_intervals(PowerIntervals(horizon, IDS, bounds)),
    }
    for index, uav in enumerate(IDS):
        messages[topics.trajectory(uav)] = encode_trajectory(eastward(100.0 * index), uav)
        messages[topics.pose(uav)] = encode_pose(pose(0.1, 0.5, 100.0 * index))
    return messages


def _tampered(rng: random.Random, payload: bytes) -> bytes:
    """Bytes changed, cut, put in or replaced by extreme lengths; the header is left alone."""
    data = bytearray(payload)
    for _ in range(rng.randint(1, 4)):
        place, kind = rng.randrange(4, max(len(data), 5)), rng.random()
        if kind < 0.5:
            data[place : place + 1] = bytes([rng.randrange(256)])
        elif kind < 0.7:
            del data[max(place, 8) :]
        elif kind < 0.85:
            data[place : place + 4] = rng.choice(WORDS)
        else:
            data[place:place] = rng.randbytes(rng.randint(1, 9))
    return bytes(data) + bytes(-len(data) % 4)


@pytest.mark.slow
def test_tampered_messages_stop_nothing() -> None:
    """Counted by field, never a crash, and good ones still make a schedule."""
    rng = random.Random(20261122)
    kinds = {topics.ADJACENCY: UInt8MultiArray, topics.POWER_INTERVAL: Float64MultiArray}
    for uav in IDS:
        kinds |= {topics.trajectory(uav): MultiDOFJointTrajectory, topics.pose(uav): PoseStamped}
    with Graph() as graph:
        nodes = [graph.add(kind, use_sim_time=True) for kind in (TopologyNode, PowerNode)]
        publishers = {
            topic: graph.observer.create_publisher(
                kind, topic, qos.default() if topic.endswith("/pose") else qos.latched()
            )
            for topic, kind in kinds.items()
        }
        good = _good_messages()
        payloads = {topic: bytes(serialize_message(message)) for topic, message in good.items()}
        graph.at(0.1)
        sent = 0
        for _ in range(COUNT):
            topic = rng.choice(sorted(payloads))
            try:
                publishers[topic].publish(_tampered(rng, payloads[topic]))
            except RCLError:
                # The middleware itself refuses to send some of them.
                continue
            sent += 1
            graph.executor.spin_once(timeout_sec=0.001)
            graph.executor.spin_once(timeout_sec=0.0)
        assert sent > COUNT / 3
        schedules = graph.collect(Float64MultiArray, topics.POWER_SCHEDULE, qos.latched())
        for topic, message in good.items():
            publishers[topic].publish(message)
        graph.until(lambda: schedules)
        for node in nodes:
            assert sum(node.intake.counts.values()) > 50
