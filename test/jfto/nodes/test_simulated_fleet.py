"""Simulated vehicles on a plan's pads, and the time that all of them keep."""

from __future__ import annotations

import math
import time
from dataclasses import replace

import pytest
from diagnostic_msgs.msg import DiagnosticArray
from rosgraph_msgs.msg import Clock
from std_msgs.msg import Float64, Float64MultiArray, Header

from jfto.nodes.simulated_fleet import SimulatedFleetNode
from jfto.simulation.fleet import FleetTime, hesitations_s, vehicle_configs
from jfto_mavlink.io.address import free_udp_port
from jfto_msgs_py.errors import JftoError
from jfto_msgs_py.plan_file import write_plan
from jfto_msgs_py.records.battery import Battery
from jfto_msgs_py.records.plan import Plan
from jfto_msgs_py.ros import qos, topics
from jfto_msgs_py.ros.air import ARRAY_OF_TOPIC as AIR
from jfto_msgs_py.ros.air import decode_air
from jfto_msgs_py.ros.diagnostics import OK
from jfto_msgs_py.ros.stamps import decode_time
from jfto_msgs_py.scenario import Given, make_scenario
from jfto_msgs_py.scenario.simulation import SimulationPart
from jfto_power.node.radio_node import RadioNode
from jfto_sim import Vehicle, VehicleConfig
from jfto_sim.server import ServerSettings, SimServer
from support.graph import Graph
from support.plans import side_by_side


def _one_uav() -> Plan:
    plan = side_by_side(make_scenario([{"fleet.count": Given(3, "test")}]))
    return replace(plan, uavs=plan.uavs[:1])


def test_time_goes_on_from_where_it_began_and_then_by_the_vehicles() -> None:
    """A restarted process goes on where the last one was; stalled vehicles stall the time."""
    began_s = time.time() - 60.0
    fleet_time = FleetTime(10.0, began_s)
    ahead_s = fleet_time.now_ns() / 1e9 - began_s
    assert 600.0 <= ahead_s <= 600.0 + 10 * (time.time() - began_s - 60.0) + 1e-3
    boot_ns = fleet_time.now_ns()
    configs = vehicle_configs(_one_uav(), boot_ns)
    with SimServer(configs, ServerSettings((("udp:127.0.0.1:0",),))) as server:
        fleet_time.follow(server, boot_ns)
        end_s = time.monotonic() + 30.0
        while not server.elapsed_s:
            assert time.monotonic() < end_s
    assert fleet_time.now_ns() == boot_ns + round(server.elapsed_s * 1e9)
    assert fleet_time.now_ns() - boot_ns < 30e9


def test_a_restart_does_not_set_a_vehicles_utc_back() -> None:
    """The time that it is dark counts."""
    vehicle = Vehicle(VehicleConfig(utc_at_boot_us=10**15))
    vehicle.advance(2.5)
    vehicle.reboot()
    vehicle.advance(2.0)
    assert vehicle.utc_us == pytest.approx(10**15 + 4_500_000, abs=1.0)


def test_vehicles_stand_on_the_pads_of_the_plan() -> None:
    """System ids in the order of the fleet, heights above sea level."""
    plan = side_by_side(make_scenario([{"fleet.count": Given(3, "test")}]))
    configs = vehicle_configs(plan, 10**18, SimulationPart(seed=5))
    assert [config.sysid for config in configs] == list(range(1, len(plan.uavs) + 1))
    height_m = plan.origin.alt_m + plan.uavs[0].start_m[2]
    assert configs[0].home_alt_m == pytest.approx(height_m, abs=0.1)
    assert configs[1].seed == 6


def test_the_clock_runs_before_there_are_vehicles(tmp_path) -> None:
    """The planner, which has still to write their pads, needs a time."""
    with Graph() as graph:
        graph.add(
            SimulatedFleetNode, None, plan_file=str(tmp_path / "none.json"), speedup=20.0,
            endpoint=f"udpto:127.0.0.1:{free_udp_port()}", use_sim_time=True,
        )  # fmt: skip
        ticks = graph.collect(Clock, topics.CLOCK, qos.clock())
        said = graph.collect(DiagnosticArray, topics.DIAGNOSTICS, qos.default())
        stamps, begun_s = [], time.monotonic()

        def gained() -> bool:
            """Five times the wall's time has passed, however late the first tick came."""
            stamps[:] = [decode_time(tick.clock) for tick in ticks]
            return (stamps[-1] - stamps[0]) / 1e9 > 5 * (time.monotonic() - begun_s)

        graph.until(lambda: len(ticks) > 20 and said and gained())
    assert stamps == sorted(stamps)
    assert "none.json is not there yet" in said[-1].status[0].message


def test_a_fleet_without_a_plan_is_refused() -> None:
    """Nobody knows where its vehicles would stand."""
    with Graph() as graph, pytest.raises(JftoError, match="plan_file is empty"):
        graph.add(SimulatedFleetNode)


def test_the_air_hears_setpoints_and_tells_what_became_of_them(tmp_path) -> None:
    """From the radio node's setpoint to the power sent, the links and the rates, in their time."""
    plan = side_by_side(make_scenario([{"fleet.count": Given(3, "test")}]))
    write_plan(plan, tmp_path / "plan.json")
    control = free_udp_port()
    with Graph() as graph:
        graph.add(
            SimulatedFleetNode, None, plan_file=str(tmp_path / "plan.json"), speedup=5.0,
            endpoint=f"udpto:127.0.0.1:{free_udp_port()}", control_port=control,
            simulation__path_loss_error_db=3.0,
        )  # fmt: skip
        got = {topic: graph.collect(Float64MultiArray, topic, qos.default()) for topic in AIR}
        graph.until(lambda: all(got.values()))
        graph.add(RadioNode, driver="sim", control=f"127.0.0.1:{control}")
        power = graph.observer.create_publisher(Float64, topics.tx_power("uav1"), qos.latched())
        power.publish(Float64(data=10.0))

        def label(topic):
            return got[topic][-1].layout.dim[0].label

        graph.until(
            lambda: (
                got[topics.AIR_POWER][-1].data[0] == pytest.approx(0.01)
                and len({label(topic) for topic in AIR}) == 1
            )
        )
        report = decode_air({topic: messages[-1] for topic, messages in got.items()})
    assert report.uav_ids == ("uav1", "uav2", "uav3")
    assert report.energy_j.tolist() == [0.0, 0.0, 0.0]
    # 100 m in free space lose 74.2 dB with 3 dBi at both ends; 3 dB more were asked for.
    assert 10 * math.log10(report.gain[0, 1]) == pytest.approx(-77.2, abs=0.1)
    # 10 dBm of the one, 30 dBm of the others: -67 dBm are heard at 100 m, -73 dBm are not at 200 m.
    assert report.links.tolist() == [
        [False, True, False],
        [True, False, True],
        [False, True, False],
    ]


@pytest.mark.slow
def test_their_time_waits_for_a_node_that_falls_behind(tmp_path) -> None:
    """It goes on with its reports, stands without them, and at real time once patience is over."""
    plan = side_by_side(make_scenario([{"fleet.count": Given(3, "test")}]))
    write_plan(plan, tmp_path / "plan.json")
    with Graph() as graph:
        node = graph.add(
            SimulatedFleetNode, None, plan_file=str(tmp_path / "plan.json"), speedup=20.0,
            endpoint=f"udpto:127.0.0.1:{free_udp_port()}", patience_s=4.0,
        )  # fmt: skip
        reports = graph.observer.create_publisher(Header, topics.CLOCK_TAKEN, qos.reports())
        clock_ns, reporting = [0], [True]

        def on_tick(tick):
            clock_ns.append(decode_time(tick.clock))
            if reporting[0]:
                reports.publish(Header(stamp=tick.clock, frame_id="observer"))

        graph.observer.create_subscription(Clock, topics.CLOCK, on_tick, qos.clock())
        graph.until(lambda: node.statuses(0)[0].level == OK and clock_ns[-1])
        begun_ns = clock_ns[-1]
        graph.until(lambda: clock_ns[-1] > begun_ns + 20e9)
        reporting[0] = False
        last_ns = clock_ns[-1]
        graph.until(lambda: clock_ns[-1] == clock_ns[-10])
        assert clock_ns[-1] - last_ns < 1.5e9
        graph.until(lambda: "not waiting for observer" in node.statuses(0)[0].text)
        given_up_ns, wall_s = clock_ns[-1], time.monotonic()
        graph.until(lambda: clock_ns[-1] > given_up_ns + 2e9)
        # 2 s at real time, 0.1 s as fast as was asked; a tick may be read when it is old.
        assert time.monotonic() - wall_s > 0.4
        reporting[0] = True
        back_ns = clock_ns[-1]
        graph.until(lambda: clock_ns[-1] > back_ns + 20e9)
        assert node.statuses(0)[0].level == OK


def test_errors_of_the_scenario_reach_the_vehicles() -> None:
    """Late starts are half-normal and of the seed; none without an error."""
    assert hesitations_s(3, SimulationPart()) == [0.0, 0.0, 0.0]
    late = hesitations_s(500, SimulationPart(time_error_s=3.0, seed=4))
    assert min(late) >= 0.0
    # The mean of a half-normal draw is 0.8 σ.
    assert sum(late) / 500 == pytest.approx(2.4, abs=0.25)
    assert late[:3] == hesitations_s(3, SimulationPart(time_error_s=3.0, seed=4))
    errors = SimulationPart(time_error_s=3.0, seed=4)
    assert vehicle_configs(_one_uav(), 10**18, errors)[0].hesitation_s == late[0]


def test_a_node_that_is_cleaned_up_has_no_vehicles_and_no_clock(tmp_path) -> None:
    """Deactivated it is silent; activated again, the clock goes on and never back."""
    with Graph() as graph:
        node = graph.add(
            SimulatedFleetNode, None, plan_file=str(tmp_path / "none.json"),
            endpoint=f"udpto:127.0.0.1:{free_udp_port()}",
        )  # fmt: skip
        ticks = graph.collect(Clock, topics.CLOCK, qos.clock())
        graph.until(lambda: len(ticks) > 3)
        node.trigger_deactivate()
        node.trigger_cleanup()
        graph.until(lambda: graph.observer.count_publishers(topics.CLOCK) == 1)
        before_ns = decode_time(ticks[-1].clock)
        ticks.clear()
        node.trigger_configure()
        node.trigger_activate()
        graph.until(lambda: ticks)
    assert decode_time(ticks[0].clock) >= before_ns


def test_a_vehicle_has_the_battery_that_was_planned_with() -> None:
    """Its capacity at 12.6 V; the vehicle's own default where nobody said."""
    plan = _one_uav()
    assert "BATT_CAPACITY" not in vehicle_configs(plan, 10**18)[0].parameters
    battery = Battery(capacity_wh=126.0, hover_power_w=355.0, cruise_power_w=380.0)
    plan = replace(plan, uavs=(replace(plan.uavs[0], battery=battery),))
    assert vehicle_configs(plan, 10**18)[0].parameters["BATT_CAPACITY"] == 10_000
