"""The power node: what the core makes, over the graph; its file, and messages that are none."""

from __future__ import annotations

import json

import numpy as np
import pytest
from diagnostic_msgs.msg import DiagnosticArray
from rcl_interfaces.msg import Log
from std_msgs.msg import Float64, Float64MultiArray, UInt8MultiArray
from trajectory_msgs.msg import MultiDOFJointTrajectory

from jfto_msgs_py.errors import InputError
from jfto_msgs_py.records.event import ERROR, Event
from jfto_msgs_py.records.network import Adjacency, PowerIntervals, SlotHorizon
from jfto_msgs_py.ros import qos, topics
from jfto_msgs_py.ros.events import decode_event
from jfto_msgs_py.ros.network import (
    decode_power_schedule,
    encode_adjacency,
    encode_power_intervals,
)
from jfto_msgs_py.ros.vehicle import encode_trajectory
from jfto_msgs_py.units import w_to_dbm
from jfto_power.node.power_node import PowerNode
from support.fleets import at, eastward
from support.graph import Graph

IDS = ("uav1", "uav2", "uav3")
DURATION_S = 2.0


class _Topology:
    """Stands where the topology node is: a chain of three, 10 mW to 1 W."""

    def __init__(self, graph: Graph) -> None:
        node = graph.observer
        self.graph = graph
        self.adjacency = node.create_publisher(UInt8MultiArray, topics.ADJACENCY, qos.latched())
        self.intervals = node.create_publisher(
            Float64MultiArray, topics.POWER_INTERVAL, qos.latched()
        )
        self.trajectories = [
            node.create_publisher(MultiDOFJointTrajectory, topics.trajectory(uav), qos.latched())
            for uav in IDS
        ]
        self.schedules = graph.collect(Float64MultiArray, topics.POWER_SCHEDULE, qos.latched())
        self.setpoints = {
            uav: graph.collect(Float64, topics.tx_power(uav), qos.latched()) for uav in IDS
        }
        self.heard = graph.collect(Log, topics.EVENTS, qos.events())
        self.diagnostics = graph.collect(DiagnosticArray, topics.DIAGNOSTICS, qos.default())

    def plan(self) -> None:
        for index, uav in enumerate(IDS):
            self.trajectories[index].publish(encode_trajectory(eastward(100.0 * index), uav))

    def publish(self, first: int, count: int = 4, ids: tuple[str, ...] = IDS) -> None:
        horizon = SlotHorizon(first, at(first * DURATION_S), DURATION_S, count)
        links = np.zeros((count, 3, 3), dtype=bool)
        links[:, [0, 1, 1, 2], [1, 0, 2, 1]] = True
        bounds = np.broadcast_to([0.01, 1.0], (count, 3, 2)).copy()
        self.adjacency.publish(encode_adjacency(Adjacency(horizon, ids, links)))
        self.intervals.publish(encode_power_intervals(PowerIntervals(horizon, ids, bounds)))

    def schedule(self):
        return decode_power_schedule(self.schedules[-1])

    def events(self, kind: str) -> list[Event]:
        return [each for each in map(decode_event, self.heard) if each.kind == kind]

    def facts(self, name: str) -> dict[str, str]:
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


def _start(graph: Graph, energy_j: float = 8.0, **parameters) -> _Topology:
    graph.add(PowerNode, use_sim_time=True, fleet__energy_j=[energy_j], **parameters)
    topology = _Topology(graph)
    topology.plan()
    return topology


def test_schedule_and_setpoints_of_a_horizon(graph) -> None:
    """Powers keep to their intervals and the energy's share; the setpoint is the first row, dBm."""
    topology = _start(graph)
    graph.at(0.1)
    topology.publish(0)
    graph.until(lambda: topology.schedules and all(topology.setpoints.values()))
    schedule = topology.schedule()
    assert schedule.uav_ids == IDS
    assert (schedule.power_w >= 0.01).all()
    assert (schedule.power_w <= 1.0).all()
    assert schedule.power_w.sum(axis=0).max() * DURATION_S <= 8.0 * 4 / 11 * (1 + 1e-9)
    for index, uav in enumerate(IDS):
        assert topology.setpoints[uav][0].data == pytest.approx(
            w_to_dbm(schedule.power_w[0, index])
        )


def test_energy_is_charged_and_outlives_a_restart(graph, tmp_path) -> None:
    """What the powers in force drew is gone, also what they drew while no node ran."""
    file = tmp_path / "energy.json"
    topology = _start(graph, state_file=str(file))
    first = graph.newest
    graph.at(0.0)
    topology.publish(0, 11)
    graph.until(lambda: all(topology.setpoints.values()))
    power_w = topology.schedule().power_w[0]
    graph.remove(first)
    second = graph.add(PowerNode, use_sim_time=True, fleet__energy_j=[8.0], state_file=str(file))
    topology.schedules.clear()
    graph.at(4.0)
    topology.publish(2, 9)
    graph.until(lambda: topology.schedules)
    left = [second.core.account.left_j[uav] for uav in IDS]
    assert np.allclose(left, 8.0 - 4.0 * power_w)
    assert json.loads(file.read_text())["left_j"]["uav1"] == pytest.approx(left[0])


def test_an_account_of_another_fleet_is_refused(graph, tmp_path) -> None:
    """The node does not start on it, and says what to do."""
    file = tmp_path / "energy.json"
    document = {"format": "jfto-energy", "version": 2, "at_ns": 0, "charged_from_ns": None}
    document |= {"budget_j": {}, "left_j": {}, "power_w": {}}
    file.write_text(json.dumps(document))
    with pytest.raises(InputError, match="other budgets or another fleet"):
        graph.add(PowerNode, state_file=str(file))


def test_one_uav_of_its_own(graph) -> None:
    """With uav_id only that UAV's row and setpoint are published."""
    topology = _start(graph, uav_id="uav2")
    graph.at(0.1)
    topology.publish(0)
    graph.until(lambda: topology.schedules and topology.setpoints["uav2"])
    assert topology.schedule().uav_ids == ("uav2",)
    assert graph.observer.count_publishers(topics.tx_power("uav1")) == 0


def test_malformed_messages_are_counted(graph) -> None:
    """Wrong sizes, strange UAVs: counted by field, and the next good pair is solved."""
    topology = _start(graph)
    graph.at(0.1)
    short = UInt8MultiArray(data=[1, 0])
    topology.adjacency.publish(short)
    topology.publish(0, ids=("uav1", "uav2", "ghost"))
    for step in range(1, 12):
        graph.at(0.1 + 1.1 * step)
        if "malformed /jfto/topology/adjacency uav.ids" in topology.facts("power_node"):
            break
    graph.until(
        lambda: (
            topology.facts("power_node").keys()
            >= {
                "malformed /jfto/topology/adjacency uav.ids",
                "malformed /jfto/topology/power_interval uav.ids",
            }
        )
    )
    topology.publish(1)
    graph.until(lambda: topology.schedules)
    assert topology.schedule().uav_ids == IDS


def test_a_radio_whose_energy_is_used_up_is_put_to_silence_at_once(graph) -> None:
    """The last row stays in force beyond its slot until 0.5 J are gone; never below zero."""
    topology = _start(graph, energy_j=0.5)
    graph.at(0.0)
    topology.publish(10, 1)
    graph.until(lambda: topology.schedules and all(topology.setpoints.values()))
    assert topology.schedule().power_w[0].tolist() == [0.01, 0.01, 0.01]
    account = graph.newest.core.account
    graph.at(30.0)
    assert not topology.events("energy")
    graph.at(50.0)
    graph.until(lambda: len(topology.events("energy")) == 3)
    graph.until(lambda: all(len(got) == 2 for got in topology.setpoints.values()))
    assert topology.setpoints["uav1"][-1].data == float("-inf")
    assert max(account.left_j.values()) < 1e-6
    assert topology.events("energy")[0].level == ERROR


def test_nothing_is_solved_before_simulated_time_has_come(graph) -> None:
    """A topology that came before is solved at the first tick, and nothing charged until then."""
    topology = _start(graph)
    node = graph.newest
    topology.publish(0)
    graph.until(lambda: node.core.due(0))
    assert topology.schedules == []
    graph.at(0.1)
    graph.until(lambda: topology.schedules)
    assert set(node.core.account.left_j.values()) == {8.0}
