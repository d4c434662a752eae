"""The radio node: setpoints applied, read back, told; radios that do not obey."""

from __future__ import annotations

import numpy as np
import pytest
from diagnostic_msgs.msg import DiagnosticArray
from rcl_interfaces.msg import Log
from std_msgs.msg import Float64

from jfto_msgs_py.errors import InputError
from jfto_msgs_py.records.event import ERROR, INFO
from jfto_msgs_py.records.radio import Radio
from jfto_msgs_py.ros import qos, topics
from jfto_msgs_py.ros.events import decode_event
from jfto_power.node.radio_node import RadioNode
from jfto_sim.air import Air, AirMember, FleetAir
from jfto_sim.config import fleet
from jfto_sim.server import ServerSettings, SimServer
from support.graph import Graph

IDS = ("uav1", "uav2", "uav3")


@pytest.fixture
def graph():
    """A graph with time of its own."""
    with Graph(answers_later=False) as found:
        yield found


@pytest.fixture
def server():
    """Three simulated vehicles with radios of 27 dBm at most."""
    air = Air([AirMember(uav, 27.0, 100.0) for uav in IDS], Radio())
    carried = FleetAir(air, lambda lat, _lon, alt: np.zeros((len(lat), 3)) + alt[:, None])
    settings = ServerSettings((("udp:127.0.0.1:0",),) * 3, control_port=0)
    with SimServer(fleet(3), settings, carried) as running:
        yield running


class _Power:
    """Stands where the power node is, and hears what the radio node says."""

    def __init__(self, graph: Graph) -> None:
        node = graph.observer
        self.setpoint = {
            uav: node.create_publisher(Float64, topics.tx_power(uav), qos.latched()) for uav in IDS
        }
        self.applied = {
            uav: graph.collect(Float64, topics.tx_power_applied(uav), qos.latched()) for uav in IDS
        }
        self.events = graph.collect(Log, topics.EVENTS, qos.events())
        self.diagnostics = graph.collect(DiagnosticArray, topics.DIAGNOSTICS, qos.default())

    def publish(self, uav: str, dbm: float) -> None:
        self.setpoint[uav].publish(Float64(data=dbm))

    def last(self, uav: str) -> float | None:
        return self.applied[uav][-1].data if self.applied[uav] else None

    def status(self, name: str):
        for message in reversed(self.diagnostics):
            for status in message.status:
                if status.name == name:
                    return status
        return None


def control(server: SimServer) -> dict:
    """Parameters that lead to a simulator."""
    host, port = server.control_address
    return {"driver": "sim", "control": f"{host}:{port}"}


def test_setpoints_reach_the_radios_and_come_back(graph, server) -> None:
    """Each UAV's own; a setpoint beyond the radio comes back as what it can do; -inf is silence."""
    power = _Power(graph)
    graph.add(RadioNode, **control(server))
    for uav, dbm in zip(IDS, (20.5, 27.9, -np.inf), strict=True):
        power.publish(uav, dbm)
    graph.until(lambda: [power.last(uav) for uav in IDS] == [20.5, 27.0, -np.inf])
    assert [server.air.air.power_dbm(uav) for uav in IDS] == [20.5, 27.0, -np.inf]
    graph.until(lambda: power.status("radio_node: uav1") is not None)
    assert power.events == []


def test_a_setpoint_given_before_the_node_came_is_applied(graph, server) -> None:
    """The topic keeps its last value: a restarted node has the radios right at once."""
    power = _Power(graph)
    power.publish("uav2", 21.0)
    graph.add(RadioNode, **control(server))
    graph.until(lambda: power.last("uav2") == 21.0)
    assert server.air.air.power_dbm("uav2") == 21.0


@pytest.mark.slow
def test_a_radio_that_does_not_obey_is_told_once_and_again_when_it_does(graph, server) -> None:
    """An error event with both figures, an error in diagnostics, and one line at the end."""
    power = _Power(graph)
    graph.add(RadioNode, **control(server))
    server.fault("radio 3 stuck")
    power.publish("uav3", 15.0)
    graph.until(lambda: len(power.events) == 1)
    event = decode_event(power.events[0])
    assert (event.level, event.kind, event.uav_id) == (ERROR, "radio", "uav3")
    assert event.text.startswith("It sends at 27.00 dBm where 15.00 dBm were set.")
    assert power.last("uav3") == 27.0
    graph.until(lambda: getattr(power.status("radio_node"), "level", None) == b"\x02")
    assert power.status("radio_node").message == "radios not as wanted: uav3"
    server.fault("radio 3 mend")
    graph.until(lambda: len(power.events) == 2)
    event = decode_event(power.events[1])
    assert (event.level, event.text) == (INFO, "The radio obeys again: 15.00 dBm are in force.")


def test_a_dead_radio_does_not_hold_up_the_others(graph, server) -> None:
    """Its trouble is the simulator's answer; the other radios are set."""
    power = _Power(graph)
    graph.add(RadioNode, **control(server))
    server.fault("radio 1 dead")
    power.publish("uav1", 20.0)
    power.publish("uav2", 20.0)
    graph.until(lambda: power.last("uav2") == 20.0 and len(power.events) == 1)
    event = decode_event(power.events[0])
    assert event.uav_id == "uav1"
    assert "The radio of uav1 does not answer: it is dead" in event.text
    assert power.last("uav1") is None


def test_aboard_one_uav_only_its_own_radio_is_served(graph, tmp_path) -> None:
    """With uav_id the others' setpoints are none of its business; the log file has the lines."""
    log = tmp_path / "radio.log"
    power = _Power(graph)
    graph.add(RadioNode, uav_id="uav2", driver="log", log_file=str(log))
    power.publish("uav1", 20.0)
    power.publish("uav2", 21.25)
    graph.until(lambda: power.last("uav2") == 21.25)
    assert power.last("uav1") is None
    assert log.read_text().endswith(" uav2: tx power 21.25 dBm\n")
    assert "uav1" not in log.read_text()


def test_a_setpoint_that_is_no_number_is_dropped_and_counted(graph) -> None:
    """NaN reaches no radio; diagnostics name the topic and the field."""
    power = _Power(graph)
    node = graph.add(RadioNode)
    power.publish("uav1", float("nan"))
    graph.until(lambda: node.intake.counts["/uav1/jfto/tx_power", "data"] == 1)
    assert power.last("uav1") is None


@pytest.mark.parametrize(
    ("parameters", "reason"),
    [
        ({"uav_id": "uav9"}, "must be one of uav1, uav2, uav3"),
        ({"driver": "iw"}, "say whose it is with uav_id"),
        ({"driver": "sim", "control": "nowhere"}, "must be host:port"),
        ({"driver": "smoke"}, "must be one of log, sim, iw"),
    ],
)
def test_parameters_that_do_not_fit_are_refused(graph, parameters, reason) -> None:
    """The node does not start, and says what would be right."""
    with pytest.raises(InputError, match=reason):
        graph.add(RadioNode, **parameters)
