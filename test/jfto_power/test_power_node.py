"""The power node: schedules, setpoints and the energy account."""

from __future__ import annotations

import json

import numpy as np
import pytest
from diagnostic_msgs.msg import DiagnosticArray
from rcl_interfaces.msg import Log
from std_msgs.msg import Float64, Float64MultiArray, UInt8MultiArray
from trajectory_msgs.msg import MultiDOFJointTrajectory

from jfto_msgs_py.errors import InputError
from jfto_msgs_py.network import Adjacency, PowerIntervals, SlotHorizon
from jfto_msgs_py.records.event import ERROR, INFO, WARN, Event
from jfto_msgs_py.ros import qos, topics
from jfto_msgs_py.ros.energy import decode_energy_left
from jfto_msgs_py.ros.events import decode_event
from jfto_msgs_py.ros.network import (
    decode_power_schedule,
    encode_adjacency,
    encode_power_intervals,
)
from jfto_msgs_py.ros.vehicle import encode_trajectory
from jfto_msgs_py.units import w_to_dbm
from jfto_power.power_node import PowerNode
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


def test_half_a_pair_solves_nothing(graph) -> None:
    """Adjacency of one slot and intervals of another are not of one horizon."""
    topology = _start(graph)
    graph.at(0.1)
    topology.publish(0)
    graph.until(lambda: len(topology.schedules) == 1)
    horizon = SlotHorizon(1, at(DURATION_S), DURATION_S, 2)
    links = np.zeros((2, 3, 3), dtype=bool)
    topology.adjacency.publish(encode_adjacency(Adjacency(horizon, IDS, links)))
    graph.at(2.1)
    topology.publish(2, 1)
    graph.until(lambda: len(topology.schedules) == 2)
    assert topology.schedule().horizon.first == 2


def test_a_silent_topology_stops_no_setpoint(graph) -> None:
    """The last schedule goes on row by row; diagnostics tell of the silence."""
    topology = _start(graph, energy_j=3.0)
    graph.at(0.1)
    topology.publish(0)
    graph.until(lambda: topology.schedules and all(topology.setpoints.values()))
    account = graph.newest._account
    for slot in (1, 2, 3):
        graph.at(slot * DURATION_S + 0.1)
        row = topology.schedule().power_w[slot]
        graph.until(lambda row=row: np.allclose([account.power_w[uav] for uav in IDS], row))
    graph.until(lambda: "topology silent" in topology.facts("power_node").get("text", ""))
    last = topology.schedule().power_w[3]
    assert np.allclose([account.power_w[uav] for uav in IDS], last)


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
    left = [second._account.left_j[uav] for uav in IDS]
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


def test_nodes_of_single_uavs_agree_with_one_for_all(graph) -> None:
    """Each solves the whole problem, so that its row is the fleet's; all use the same energy."""
    topology = _start(graph)
    graph.at(0.1)
    topology.publish(0)
    graph.until(lambda: topology.schedules)
    whole = topology.schedule().power_w
    graph.remove(graph.newest)
    for uav in IDS:
        graph.add(PowerNode, use_sim_time=True, fleet__energy_j=[8.0], uav_id=uav)
    # Three publishers of one topic: a reader that keeps one message would see the last only.
    deep = qos.latched()
    deep.depth = len(IDS)
    got = graph.collect(Float64MultiArray, topics.POWER_SCHEDULE, deep)
    graph.at(0.2)
    topology.publish(0)

    def rows() -> dict:
        schedules = [decode_power_schedule(message) for message in got]
        return {ids[0]: each for each in schedules if len(ids := each.uav_ids) == 1}

    graph.until(lambda: len(rows()) == 3)
    found = np.stack([rows()[uav].power_w[:, 0] for uav in IDS], axis=1)
    assert np.allclose(found, whole, rtol=1e-3)


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


def test_a_shortage_is_told(graph) -> None:
    """Where the least powers cost more than is left, diagnostics name the UAVs."""
    topology = _start(graph, energy_j=0.01)
    graph.at(0.1)
    topology.publish(0)
    graph.until(lambda: topology.schedules)
    for step in range(1, 4):
        graph.at(0.1 + 1.1 * step)
    graph.until(lambda: topology.facts("power_node").get("level") == "2")
    assert "uav1" in topology.facts("power_node")["text"]
    graph.until(lambda: len(topology.events("energy")) == 3)
    event = topology.events("energy")[0]
    assert (event.level, event.uav_id) == (WARN, "uav1")
    assert event.text == (
        "uav1 lacks 0.07 J for the least powers of its topology: it is held until slot 0 and "
        "silent then, the others go on."
    )


def test_silence_of_the_topology_is_told_once_and_its_end(graph) -> None:
    """Two slots without news: WARN; past the horizon: ERROR; heard again: over."""
    topology = _start(graph)
    graph.at(0.1)
    topology.publish(0)
    graph.until(lambda: topology.schedules)
    for seconds in (2.0, 4.2, 5.3, 6.4, 7.5, 8.6, 9.7):
        graph.at(seconds)
    graph.until(lambda: len(topology.events("topology")) == 2)
    topology.publish(5)
    graph.until(lambda: len(topology.schedules) == 2)
    graph.at(10.8)
    graph.until(lambda: len(topology.events("topology")) == 3)
    assert [event.level for event in topology.events("topology")] == [WARN, ERROR, INFO]


def test_a_radio_whose_energy_is_used_up_is_put_to_silence_at_once(graph) -> None:
    """The last row stays in force beyond its slot until 0.5 J are gone; never below zero."""
    topology = _start(graph, energy_j=0.5)
    graph.at(0.0)
    topology.publish(10, 1)
    graph.until(lambda: topology.schedules and all(topology.setpoints.values()))
    assert topology.schedule().power_w[0].tolist() == [0.01, 0.01, 0.01]
    account = graph.newest._account
    graph.at(30.0)
    assert not topology.events("energy")
    graph.at(50.0)
    graph.until(lambda: len(topology.events("energy")) == 3)
    graph.until(lambda: all(len(got) == 2 for got in topology.setpoints.values()))
    assert topology.setpoints["uav1"][-1].data == float("-inf")
    assert max(account.left_j.values()) < 1e-6
    assert topology.events("energy")[0].level == ERROR


def test_nothing_is_charged_on_the_pads(graph) -> None:
    """Setpoints are in force before time zero, and their energy is not counted."""
    topology = _start(graph)
    energy = graph.collect(Float64MultiArray, topics.ENERGY_LEFT, qos.latched())
    graph.at(-30.0)
    topology.publish(0)
    graph.until(lambda: all(topology.setpoints.values()) and energy)
    graph.at(0.0)
    topology.publish(0, 3)
    graph.until(lambda: len(topology.schedules) == 2)
    graph.until(lambda: len(energy) >= 2)
    assert decode_energy_left(energy[-1]) == {"uav1": 8.0, "uav2": 8.0, "uav3": 8.0}


def test_a_late_joiner_begins_in_the_slot_that_is_on(graph) -> None:
    """A node that hears of slots 0 to 3 in slot 2 schedules slots 2 and 3, and pays for those."""
    topology = _start(graph)
    graph.at(4.5)
    topology.publish(0)
    graph.until(lambda: topology.schedules)
    horizon = topology.schedule().horizon
    assert (horizon.first, horizon.count, horizon.t0_ns) == (2, 2, at(4.0))


def test_a_topology_of_fewer_uavs_leaves_the_others_their_power(graph) -> None:
    """Two of three are scheduled anew; the third keeps its setpoint, and diagnostics say so."""
    topology = _start(graph)
    graph.at(0.1)
    topology.publish(0)
    graph.until(lambda: all(topology.setpoints.values()))
    account = graph.newest._account
    before_w = account.power_w["uav3"]
    horizon = SlotHorizon(1, at(DURATION_S), DURATION_S, 4)
    links = np.broadcast_to(~np.eye(2, dtype=bool), (4, 2, 2)).copy()
    bounds = np.broadcast_to([0.02, 0.03], (4, 2, 2)).copy()
    graph.at(2.1)
    two = ("uav1", "uav2")
    topology.adjacency.publish(encode_adjacency(Adjacency(horizon, two, links)))
    topology.intervals.publish(encode_power_intervals(PowerIntervals(horizon, two, bounds)))
    graph.until(lambda: len(topology.schedules) == 2)
    assert topology.schedule().uav_ids == two
    assert account.power_w["uav1"] == pytest.approx(0.03)
    assert account.power_w["uav3"] == before_w
