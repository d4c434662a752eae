"""The bridge node with simulated vehicles behind it."""

from __future__ import annotations

import dataclasses
import os
import signal
import subprocess
import sys
import time

import numpy as np
import pytest
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from geometry_msgs.msg import PoseStamped
from rcl_interfaces.msg import Log
from sensor_msgs.msg import BatteryState, NavSatFix
from std_srvs.srv import Trigger

from jfto.nodes.simulated_fleet import SimulatedFleetNode
from jfto_mavlink.io.address import free_udp_port
from jfto_mavlink.node import MavlinkBridgeNode
from jfto_mavlink.order_server import OrderServer
from jfto_msgs_py.errors import InputError, ScenarioError
from jfto_msgs_py.order_socket import order_socket, send_order
from jfto_msgs_py.plan_file import write_plan
from jfto_msgs_py.ros import qos, topics
from jfto_msgs_py.ros.events import decode_event
from jfto_msgs_py.ros.vehicle import decode_pose
from jfto_sim import VehicleConfig
from jfto_sim.server import ServerSettings, SimServer
from support.domains import next_domain
from support.graph import SCENARIO, Graph

TWO = {"fleet.count": 2, "starts.count": 2, "mission.slot_count": 20}
FLEET_OF_TWO = {name.replace(".", "__"): value for name, value in TWO.items()}


@pytest.fixture
def plan_file(plan, tmp_path):
    """The two-UAV plan as a file."""
    positions = np.repeat(np.array([uav.start_m for uav in plan.uavs])[:, None], 21, axis=1)
    path = tmp_path / "plan.json"
    write_plan(dataclasses.replace(plan, positions_m=positions), path)
    return path


class Station:
    """A graph with the bridge, and what it says."""

    def __init__(self, graph: Graph, plan_file, **parameters) -> None:
        self.graph = graph
        self.node = graph.add(
            MavlinkBridgeNode, plan_file=str(plan_file), **FLEET_OF_TWO, **parameters
        )
        self.diagnostics = graph.collect(DiagnosticArray, topics.DIAGNOSTICS, qos.default())

    def call(self, verb: str):
        """Answer of a service, once there is one."""
        client = self.graph.observer.create_client(Trigger, f"/jfto/mission/{verb}")
        self.graph.until(client.service_is_ready)
        future = client.call_async(Trigger.Request())
        self.graph.until(future.done)
        answer = future.result()
        return answer.success, answer.message

    def fact(self, uav: str, key: str) -> str:
        """A value of a vehicle's last diagnostics; its text under "text"."""
        for message in reversed(self.diagnostics):
            for status in message.status:
                if status.name == f"mavlink_bridge: {uav}":
                    values = {value.key: value.value for value in status.values}
                    return (values | {"text": status.message}).get(key, "")
        return ""

    def ready(self) -> None:
        """Wait until all vehicles can be armed."""
        for uav in ("uav1", "uav2"):
            self.graph.until(lambda uav=uav: self.fact(uav, "ready_to_arm") == "true")


def simulated(graph: Graph, plan_file, speedup: float) -> Station:
    """A station with a simulated fleet beside it, whose time all keep."""
    link = f"127.0.0.1:{free_udp_port()}"
    shared = {"plan_file": str(plan_file), "speedup": speedup}
    graph.add(SimulatedFleetNode, None, endpoint=f"udpto:{link}", **shared, **FLEET_OF_TWO)
    return Station(
        graph,
        plan_file,
        endpoints=[f"udpin:{link}"],
        speedup=speedup,
        vehicle_stamps=True,
        allow_arming=True,
        use_sim_time=True,
    )


@pytest.fixture
def graph():
    with Graph() as found:
        yield found


@pytest.mark.slow(6)
def test_a_fleet_is_uploaded_started_held_and_called_home(graph, plan_file):
    """Poses about the plan's origin in the order of their stamps, and each service's answer."""
    station = simulated(graph, plan_file, 10.0)
    poses = graph.collect(PoseStamped, topics.pose("uav2"), qos.sensor())
    fixes = graph.collect(NavSatFix, topics.fix("uav2"), qos.sensor())
    batteries = graph.collect(BatteryState, topics.battery("uav2"), qos.sensor())
    station.ready()
    assert station.call("pause")[0] is False
    success, text = station.call("upload")
    assert success, text
    assert "2 missions on board and verified" in text
    assert station.call("check") == (True, "ready to arm: uav1, uav2")
    assert station.fact("uav1", "armed") == "false"
    graph.until(lambda: len(poses) > 3 and fixes and batteries)
    pose = decode_pose(poses[-1])
    assert pose.position_m == pytest.approx((0.0, 20.0, 2.0), abs=0.5)
    assert abs(station.node.now_ns() - pose.stamp_ns) < 5e9
    assert fixes[-1].latitude == pytest.approx(47.3979, abs=1e-3)
    assert 0.5 < batteries[-1].percentage <= 1.0
    success, text = station.call("start")
    assert success, text
    assert text == "flying: uav1, uav2"
    graph.until(lambda: station.fact("uav1", "last_waypoint") in ("1", "3"))
    assert float(station.fact("uav1", "late_s")) == pytest.approx(0.0, abs=15.0)
    assert float(station.fact("uav1", "round_trip_s")) > 0
    graph.until(lambda: decode_pose(poses[-1]).position_m[2] > 10.0)
    success, text = station.call("pause")
    assert success, text
    assert text == "uav1 paused, uav2 paused"
    success, text = station.call("resume")
    assert success, text
    success, text = station.call("abort")
    assert success, text
    assert text == "uav1 returning, uav2 returning"
    graph.until(lambda: station.fact("uav1", "mode") == "RTL")
    stamps = [decode_pose(message).stamp_ns for message in poses]
    assert stamps == sorted(stamps)


@pytest.mark.slow(6)
def test_an_abort_calls_a_start_off(graph, plan_file):
    """While the fleet lines up: nobody flies, start says why."""
    station = simulated(graph, plan_file, 12.0)
    station.ready()
    assert station.call("upload")[0]
    client = graph.observer.create_client(Trigger, "/jfto/mission/start")
    graph.until(client.service_is_ready)
    starting = client.call_async(Trigger.Request())
    graph.until(lambda: station.fact("uav1", "mode") == "GUIDED")
    busy, words = station.call("upload")
    assert not busy
    assert "[MAV-605]" in words
    assert station.call("abort")[0]
    graph.until(starting.done)
    assert not starting.result().success
    assert "the operator aborted" in starting.result().message
    graph.until(lambda: station.fact("uav1", "armed") == "false")


@pytest.mark.slow(6)
def test_an_order_from_a_shell_reaches_the_vehicles_without_ros(graph, plan_file):
    """`jfto mission order`: all obey, and everybody is told what was ordered and came of it."""
    states = graph.collect(DiagnosticStatus, topics.MISSION_STATE, qos.latched())
    events = graph.collect(Log, topics.EVENTS, qos.events())
    station = simulated(graph, plan_file, 10.0)
    station.ready()
    assert station.call("upload")[0]
    assert station.call("start")[0]
    graph.until(lambda: states[-1].message == "in flight, start done")
    command = [sys.executable, "-m", "jfto", "mission", "order", "home"]
    environment = {**os.environ, "ROS_DOMAIN_ID": str(graph.context.get_domain_id())}
    pressed_s = time.monotonic()
    with subprocess.Popen(command, env=environment, stdout=subprocess.PIPE, text=True) as shell:
        graph.until(lambda: states[-1].message.endswith("abort under way"))
        print(f"taken by the bridge after {time.monotonic() - pressed_s:.2f} s")
        graph.until(lambda: shell.poll() is not None)
        assert shell.stdout.read() == "uav1 returning, uav2 returning\n"
        assert shell.returncode == 0
    graph.until(lambda: states[-1].message == "in flight, abort done")
    graph.until(lambda: station.fact("uav2", "mode") == "RTL")
    told = [event.text for event in map(decode_event, events) if event.kind == "order"]
    assert told[-1] == "abort: uav1 returning, uav2 returning"
    assert told[0].startswith("upload: 2 missions on board")


def test_an_order_that_fails_is_no_success_and_stays_an_alarm(graph, plan_file):
    """Whoever comes later sees it too; an order that is obeyed ends the alarm."""
    station = simulated(graph, plan_file, 10.0)
    station.ready()
    success, text = station.call("pause")
    assert not success
    states = graph.collect(DiagnosticStatus, topics.MISSION_STATE, qos.latched())
    graph.until(lambda: bool(states))
    assert states[-1].level == b"\x02"
    assert states[-1].message == text
    assert station.call("upload")[0]
    graph.until(lambda: states[-1].message == "on the ground, upload done")


def test_no_bridge_is_said_and_another_domain_named():
    """An order that nobody takes is an error at once."""
    with pytest.raises(InputError, match="no bridge runs on this computer on ROS domain 231"):
        send_order("home", 231)
    server = OrderServer(order_socket(232), lambda verb: (True, verb))
    try:
        assert send_order("home", 232) == (True, "abort")
        with pytest.raises(InputError, match=r"listened on .*\b232\b.*: set ROS_DOMAIN_ID"):
            send_order("home", 231)
        with pytest.raises(InputError, match="another bridge takes orders there"):
            OrderServer(order_socket(232), lambda verb: (True, verb))
    finally:
        server.close()


def test_real_vehicles_are_not_armed_unasked(graph, plan_file):
    """allow_arming is off by default; and vehicles that are not there are named stale."""
    station = Station(graph, plan_file, endpoints=[f"udpin:127.0.0.1:{free_udp_port()}"])
    graph.until(lambda: station.fact("uav1", "text") == "never heard")
    success, text = station.call("start")
    assert not success
    assert "allow_arming" in text
    assert "[MAV-606]" in text


@pytest.mark.slow(6)
def test_a_check_names_what_speaks_against_arming(graph, plan_file):
    """Nothing was uploaded: the check says so, and arms nobody."""
    station = simulated(graph, plan_file, 12.0)
    station.ready()
    success, text = station.call("check")
    assert not success
    assert "not the plan's mission on board" in text
    assert station.fact("uav1", "armed") == "false"


@pytest.mark.slow(6)
def test_a_plan_that_comes_later_is_waited_for(graph, plan_file):
    """The planner may still be at work; orders say so."""
    late = plan_file.with_name("late.json")
    station = simulated(graph, late, 1.0)
    graph.until(lambda: "late.json is not there yet" in station.fact("uav1", "text"))
    success, text = station.call("upload")
    assert not success
    assert "late.json is not there yet" in text
    plan_file.rename(late)
    graph.until(lambda: station.fact("uav1", "link") == "up")


@pytest.mark.parametrize(
    ("parameters", "words"),
    [
        ({"roster": ["sim:3"]}, "sim:3: the fleet has 2"),
        ({"roster": ["sim:2"]}, "simulates no vehicles. Start simulated_fleet"),
        ({"endpoints": ["tcp:a:1"], "speedup": 2.0}, "real vehicles keep time"),
        ({"roster": ["uav1=1", "uav2=2"]}, "2 roster entries have no @LINK"),
        ({"roster": ["uav1=1@udpin:127.0.0.1:14550"]}, "uav2: in the fleet or in the roster"),
        ({"endpoints": ["tcp:a:1"], "style": "hover"}, "style"),
    ],
)
def test_what_cannot_be_flown_is_refused_at_once(graph, plan_file, parameters, words):
    """With a sentence, before anything is opened."""
    with pytest.raises((Exception, ScenarioError), match=words):
        Station(graph, plan_file, **parameters)


@pytest.mark.slow(6)
@pytest.mark.parametrize("sent", [signal.SIGINT, signal.SIGTERM])
def test_the_process_ends_when_it_is_told_to(plan_file, sent):
    """With status 0 and without a traceback, its links closed."""
    port = free_udp_port()
    values = {**TWO, "plan_file": plan_file, "endpoints": f"['udpin:127.0.0.1:{port}']"}
    command = [sys.executable, "-m", "jfto.nodes", "mavlink_bridge", "--ros-args"]
    for name, value in {**SCENARIO, **values}.items():
        command += ["-p", f"{name}:={value}"]
    environment = {
        **os.environ,
        "PYTHONPATH": os.pathsep.join(sys.path),
        "ROS_DOMAIN_ID": str(next_domain()),
    }
    configs = [VehicleConfig(sysid=n) for n in (1, 2)]
    settings = ServerSettings(((f"udpto:127.0.0.1:{port}",),) * 2)
    with (
        SimServer(configs, settings),
        subprocess.Popen(
            command, env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
        ) as process,
    ):
        said = []
        for line in process.stdout:
            said.append(line)
            if "uav2: heard" in line:
                break
        process.send_signal(sent)
        said += process.stdout.readlines()
        assert process.wait(20.0) == 0, "".join(said)
    assert not any("Traceback" in line for line in said)
