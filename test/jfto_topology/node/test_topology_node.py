"""The topology node: what the core makes, over the graph; messages that are none, restarts."""

from __future__ import annotations

import numpy as np
import pytest
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import PoseStamped
from rcl_interfaces.msg import Log
from std_msgs.msg import Float64MultiArray, UInt8MultiArray
from trajectory_msgs.msg import MultiDOFJointTrajectory
from visualization_msgs.msg import Marker, MarkerArray

from jfto_msgs_py.records.event import Event
from jfto_msgs_py.records.radio import Radio
from jfto_msgs_py.ros import qos, topics
from jfto_msgs_py.ros.air import encode_air
from jfto_msgs_py.ros.events import decode_event
from jfto_msgs_py.ros.network import decode_adjacency, decode_power_intervals
from jfto_msgs_py.ros.vehicle import encode_pose, encode_trajectory
from jfto_sim.air import Air, AirMember, AirSettings
from jfto_topology.node.topology_node import TopologyNode
from support.fleets import START_NS, at, eastward, pose
from support.graph import Graph

IDS = ("uav1", "uav2", "uav3")


class _Fleet:
    """Publishes trajectories and poses of three UAVs that fly east, 100 m apart."""

    def __init__(self, graph: Graph) -> None:
        self.graph = graph
        node = graph.observer
        self.trajectories = {
            uav: node.create_publisher(
                MultiDOFJointTrajectory, topics.trajectory(uav), qos.latched()
            )
            for uav in IDS
        }
        self.poses = {
            uav: node.create_publisher(PoseStamped, topics.pose(uav), qos.sensor()) for uav in IDS
        }
        self.adjacency = graph.collect(UInt8MultiArray, topics.ADJACENCY, qos.latched())
        self.intervals = graph.collect(Float64MultiArray, topics.POWER_INTERVAL, qos.latched())
        self.markers = graph.collect(MarkerArray, topics.MARKERS, qos.latched())
        self.heard = graph.collect(Log, topics.EVENTS, qos.events())
        self.energy = node.create_publisher(Float64MultiArray, topics.ENERGY_LEFT, qos.latched())
        self.diagnostics = graph.collect(DiagnosticArray, topics.DIAGNOSTICS, qos.default())

    def plan(self) -> None:
        for index, uav in enumerate(IDS):
            self.trajectories[uav].publish(encode_trajectory(eastward(100.0 * index), uav))

    def measure(self, seconds: float, *uavs: str, lag_s: float = 0.0) -> None:
        """Poses as planned, `lag_s` late; best effort, so wait until somebody listens."""
        for uav in uavs:
            publisher = self.poses[uav]
            self.graph.until(lambda publisher=publisher: publisher.get_subscription_count())
            index = IDS.index(uav)
            publisher.publish(encode_pose(pose(seconds, 5.0 * (seconds - lag_s), 100.0 * index)))

    def events(self) -> list[Event]:
        return [decode_event(message) for message in self.heard]

    def facts(self, name: str) -> dict[str, str]:
        """Latest diagnostics of one status, its message and level with them."""
        for message in reversed(self.diagnostics):
            for status in message.status:
                if status.name == name:
                    values = {value.key: value.value for value in status.values}
                    return values | {"text": status.message, "level": str(status.level[0])}
        return {}


@pytest.fixture
def graph():
    """A graph with simulated time."""
    with Graph(answers_later=False) as found:
        yield found


def _start(graph: Graph, **parameters) -> _Fleet:
    graph.add(TopologyNode, use_sim_time=True, horizon_slots=4, **parameters)
    fleet = _Fleet(graph)
    fleet.plan()
    return fleet


def _firsts(fleet: _Fleet) -> list[int]:
    return [decode_adjacency(message).horizon.first for message in fleet.adjacency]


def test_a_slot_is_published_when_its_poses_have_come(graph) -> None:
    """Adjacency, intervals and markers of one horizon, for all UAVs, without waiting."""
    fleet = _start(graph)
    graph.at(2.1)
    fleet.measure(2.1, *IDS)
    graph.until(lambda: fleet.adjacency and fleet.intervals and fleet.markers)
    adjacency = decode_adjacency(fleet.adjacency[-1])
    intervals = decode_power_intervals(fleet.intervals[-1])
    assert adjacency.uav_ids == IDS
    assert (adjacency.horizon.first, adjacency.horizon.count) == (1, 4)
    assert adjacency.horizon == intervals.horizon
    assert adjacency.links.sum(axis=2).min() >= 1
    kinds = {marker.ns: marker.type for marker in fleet.markers[-1].markers[1:]}
    assert kinds["paths"] == Marker.LINE_STRIP
    assert kinds["links"] == Marker.LINE_LIST
    assert kinds["uavs"] == Marker.SPHERE


def test_malformed_messages_are_counted_and_nothing_stops(graph) -> None:
    """A NaN, a wrong frame and an empty trajectory are counted by field; the next slot comes."""
    fleet = _start(graph)
    counts = graph.newest.intake.counts
    graph.at(2.1)
    graph.until(fleet.poses["uav1"].get_subscription_count)
    bad = encode_pose(pose(2.1, 0.0, 0.0))
    bad.pose.position.x = float("nan")
    fleet.poses["uav1"].publish(bad)
    graph.until(lambda: len(counts) == 1)
    bad = encode_pose(pose(2.1, 0.0, 0.0))
    bad.header.frame_id = "odom"
    fleet.poses["uav1"].publish(bad)
    empty = encode_trajectory(eastward(0.0), "uav1")
    empty.points = []
    fleet.trajectories["uav1"].publish(empty)
    graph.until(lambda: len(counts) == 3)
    wanted = {
        "malformed /uav1/pose pose.position",
        "malformed /uav1/pose header.frame_id",
        "malformed /uav1/jfto/trajectory trajectory.points",
    }
    fleet.plan()
    fleet.measure(2.1, *IDS)
    graph.until(lambda: fleet.adjacency)
    for step in range(10):
        graph.at(3.2 + 1.1 * step)
        if wanted <= fleet.facts("topology_node: uav1").keys():
            break
    graph.until(lambda: wanted <= fleet.facts("topology_node: uav1").keys())
    assert len(counts) == 3


def test_an_inactive_node_is_silent(graph) -> None:
    """Deactivated it publishes nothing; activated again it solves the slot that is due."""
    fleet = _start(graph)
    node = graph.newest
    graph.at(2.1)
    fleet.measure(2.1, *IDS)
    graph.until(lambda: _firsts(fleet) == [1])
    node.trigger_deactivate()
    graph.at(4.1)
    fleet.measure(4.1, *IDS)
    graph.at(4.5)
    assert _firsts(fleet) == [1]
    node.trigger_activate()
    graph.until(lambda: _firsts(fleet) == [1, 2])


def test_a_late_joiner_gets_the_latest_topology(graph) -> None:
    """Adjacency, intervals and markers are latched."""
    fleet = _start(graph)
    graph.at(2.1)
    fleet.measure(2.1, *IDS)
    graph.until(lambda: fleet.adjacency and fleet.intervals and fleet.markers)
    late = graph.collect(UInt8MultiArray, topics.ADJACENCY, qos.latched())
    late_markers = graph.collect(MarkerArray, topics.MARKERS, qos.latched())
    graph.until(lambda: late and late_markers)
    assert decode_adjacency(late[0]).horizon.first == 1


def test_a_node_restarted_in_mid_flight_goes_on_within_a_slot(graph) -> None:
    """It gets the latched plans, finds a lag of 11 s from one pose each, and the slot they are in.

    The plan lasts 20 s, its ten slots 2 s each: at 16.5 s, 11 s late, the fleet is in slot 2.
    """
    fleet = _start(graph)
    graph.at(2.1)
    fleet.measure(2.1, *IDS)
    graph.until(lambda: _firsts(fleet) == [1])
    graph.remove(graph.newest)
    graph.add(TopologyNode, use_sim_time=True, horizon_slots=4)
    graph.at(16.5)
    fleet.measure(16.5, *IDS, lag_s=11.0)
    graph.until(lambda: len(fleet.adjacency) == 2)
    horizon = decode_adjacency(fleet.adjacency[-1]).horizon
    assert horizon.first == 2
    assert abs(horizon.t0_ns - at(15.0)) < 10**8
    graph.until(lambda: any("11 s late: its slots are shifted" in e.text for e in fleet.events()))
    for step in range(1, 4):
        graph.at(16.5 + 1.1 * step)
    graph.until(lambda: float(fleet.facts("topology_node").get("slot_shift_s", "0")) > 10)
    assert float(fleet.facts("topology_node")["fleet_lag_s"]) == pytest.approx(11.0, abs=0.1)


def _least_w(fleet: _Fleet) -> float:
    """Least power of the first UAV in the current slot of the latest topology."""
    return float(decode_power_intervals(fleet.intervals[-1]).bounds_w[0, 0, 0])


@pytest.mark.parametrize(("learn_loss", "ratio"), [(True, 2.0), (False, 1.0)])
def test_loss_that_radios_measure_raises_the_least_powers(graph, learn_loss, ratio) -> None:
    """Where links lose 3 dB more than planned, the powers double, unless that is not wanted."""
    fleet = _start(graph, learn_loss=learn_loss)
    heard = graph.observer.create_publisher(Float64MultiArray, topics.AIR_GAIN, qos.default())
    graph.at(0.5)
    fleet.measure(0.4, *IDS)
    graph.until(lambda: len(fleet.intervals) == 1)
    before = _least_w(fleet)
    air = Air(
        [AirMember(uav, 30.0, 50.0) for uav in IDS], Radio(), AirSettings(path_loss_error_db=3.0)
    )
    at = np.array([[0.0, 100.0 * index, 50.0] for index in range(3)])
    if learn_loss:
        graph.until(heard.get_subscription_count)
    # Enough of them to outweigh the belief that all is as planned.
    for report in range(100):
        stamp_ns = START_NS + round((0.5 + 0.01 * report) * 1e9)
        heard.publish(encode_air(air.step(0.01, at, stamp_ns=stamp_ns))[topics.AIR_GAIN])
        graph.executor.spin_once(timeout_sec=0.0)
    graph.at(2.1)
    fleet.measure(2.05, *IDS)
    graph.until(lambda: len(fleet.intervals) == 2)
    assert _least_w(fleet) / before == pytest.approx(ratio, rel=0.1)
