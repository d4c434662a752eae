"""A bridge that dies in mid-flight and what its successor makes of it."""

from __future__ import annotations

import json

import pytest

from jfto_mavlink.dialect import mavlink
from jfto_mavlink.fleet.monitor import FlightState
from jfto_mavlink.fleet.watched_flight import read_flight_state, write_flight_state
from jfto_mavlink.flight.control import pause, resume, return_home
from jfto_sim.modes.mode import Mode
from support.watched_flight import Flight

COMMAND_LONG = mavlink.MAVLINK_MSG_ID_COMMAND_LONG
# What may be sent to a fleet in the air that nobody gives an order.
ASKING = {
    COMMAND_LONG,
    mavlink.MAVLINK_MSG_ID_HEARTBEAT,
    mavlink.MAVLINK_MSG_ID_TIMESYNC,
    mavlink.MAVLINK_MSG_ID_MISSION_REQUEST_LIST,
    mavlink.MAVLINK_MSG_ID_MISSION_REQUEST_INT,
    mavlink.MAVLINK_MSG_ID_MISSION_ACK,
    mavlink.MAVLINK_MSG_ID_PARAM_REQUEST_READ,
}


@pytest.fixture
def state_file(tmp_path):
    return tmp_path / "flight.json"


def successor(flight: Flight, plan, state_file) -> Flight:
    """A new bridge in front of the same vehicles, which have flown on in silence meanwhile."""
    for _ in range(100):
        for vehicle in flight.vehicles.values():
            vehicle.advance(0.04)
    return Flight(plan, state_file, flight.vehicles)


@pytest.mark.slow
def test_a_flight_under_way_is_recognised_and_left_alone(plan, state_file):
    """Missions are read, nothing is written; the operator learns who flies what."""
    first = Flight(plan, state_file)
    first.start()
    first.runner.advance(15.0)
    sent = []
    second = successor(first, plan, state_file)
    send = second.runner.air.send
    second.runner.air.send = lambda data, peer: (sent.append(data), send(data, peer))
    second.recognise()
    (text,) = second.told("restart", "")
    assert text == (
        "The bridge was started in mid-flight: uav1, uav2 on the plan's mission, as read back. "
        "Nothing was uploaded, changed or disarmed; poses and orders go on."
    )
    assert [v.mode.number for v in second.vehicles.values()] == [Mode.AUTO, Mode.AUTO]
    assert second.until("landed", "", 300.0).startswith("The flight is over: uav1 landed on its")
    assert {int.from_bytes(data[7:10], "little") for data in sent} == ASKING
    commands = {int.from_bytes(data[38:40], "little") for data in sent if data[7] == COMMAND_LONG}
    assert commands == {mavlink.MAV_CMD_REQUEST_MESSAGE, mavlink.MAV_CMD_SET_MESSAGE_INTERVAL}


def test_time_zero_outlives_the_bridge(plan, state_file):
    """The successor says the same, and counts lateness from it."""
    first = Flight(plan, state_file)
    first.start()
    first.runner.advance(20.0)
    second = successor(first, plan, state_file)
    assert second.lift_offs == []
    second.recognise()
    assert second.lift_offs == first.lift_offs
    assert len(first.lift_offs) == 1
    second.runner.advance(2.0)
    one, two = first.monitor.state("uav1"), second.monitor.state("uav1")
    assert two.begun.utc_ns == pytest.approx(one.begun.utc_ns, abs=5e6)
    assert two.reached >= one.reached
    assert second.told("lift_off", "") == []


def test_orders_work_after_the_restart(plan, state_file):
    """Pause, go on, come home."""
    first = Flight(plan, state_file)
    first.start()
    first.runner.advance(15.0)
    second = successor(first, plan, state_file)
    second.recognise()
    second.runner.run(dict.fromkeys(second.missions, pause))
    assert second.runner.vehicle("uav1").mission_state == mavlink.MISSION_STATE_PAUSED
    second.runner.run(dict.fromkeys(second.missions, resume))
    assert second.runner.vehicle("uav1").mission_state == mavlink.MISSION_STATE_ACTIVE
    second.runner.run(dict.fromkeys(second.missions, return_home))
    assert second.until("landed", "", 200.0).endswith("uav2 landed on its pad.")


@pytest.mark.slow
def test_a_vehicle_lost_while_nobody_listened_is_still_missed(plan, state_file):
    """Its state file says that it flew; the end of the flight names it."""
    first = Flight(plan, state_file)
    first.start()
    first.runner.advance(15.0)
    first.vehicles["uav2"].kill()
    second = successor(first, plan, state_file)
    second.recognise()
    assert (
        "uav1 on the plan's mission, as read back; uav2 not heard"
        in (second.told("restart", "")[0])
    )
    assert second.told("vehicle", "uav2")[0].startswith(
        "uav2 is lost: not heard for 5 s, last before the restart"
    )
    assert second.until("landed", "", 300.0) == (
        "The flight is over: uav1 landed on its pad; uav2 declared lost, last heard before the "
        "restart."
    )


def test_a_vehicle_that_landed_while_nobody_listened_has_landed(plan, state_file):
    """Its end is found on the ground."""
    first = Flight(plan, state_file)
    first.start()
    first.runner.run({"uav1": return_home})
    for _ in range(3000):
        for vehicle in first.vehicles.values():
            vehicle.advance(0.04)
    second = Flight(plan, state_file, first.vehicles)
    second.recognise()
    assert second.until("landed", "uav1", 10.0) == "uav1 has landed on its pad."


def test_another_mission_on_board_is_said_not_replaced(plan, state_file):
    """It is followed and obeys; whose it is, is for the operator to know."""
    first = Flight(plan, state_file)
    first.start()
    first.runner.advance(15.0)
    first.vehicles["uav1"].params.store("WPNAV_RADIUS", 500.0)
    second = successor(first, plan, state_file)
    second.recognise()
    assert (
        "uav1 in AUTO with a mission that is not the plan's (WPNAV_RADIUS: sent 120, on board 500)."
    ) in second.told("restart", "")[0]
    assert [v.mode.number for v in second.vehicles.values()] == [Mode.AUTO, Mode.AUTO]


@pytest.mark.slow
def test_a_flight_that_began_unseen_is_placed_by_its_progress(plan, state_file):
    """Killed before lift-off was known: time zero is as the plan has the last waypoint."""
    first = Flight(plan)
    first.start()
    first.runner.advance(5.0)
    second = successor(first, plan, state_file)
    second.recognise()
    second.until("lift_off", "", 10.0)
    # A vehicle tells its UTC once in a while only.
    assert second.runner.until(lambda: bool(second.lift_offs), 5.0)
    assert second.lift_offs[0] == pytest.approx(first.lift_offs[0], abs=15e9)


def test_a_start_on_the_ground_is_no_restart(plan, state_file):
    """Nothing is told."""
    flight = Flight(plan, state_file)
    flight.runner.advance(45.0)
    flight.recognise()
    assert flight.notices == []


def test_a_state_file_is_only_for_its_own_missions(state_file):
    """Another plan's flight is not this one's; a broken file is told and written anew."""
    written = FlightState({"uav1": "a"}, 12, {"uav1": "landed on its pad"}, over=True)
    write_flight_state(written, state_file)
    assert read_flight_state({"uav1": "a"}, state_file) == written
    assert read_flight_state({"uav1": "b"}, state_file) is None
    assert json.loads(state_file.read_text())["lift_off_ns"] == 12


def test_a_broken_state_file_does_not_ground_a_bridge(plan, state_file):
    """The operator is told; the flight is kept from the state of its vehicles."""
    state_file.write_text("{", encoding="utf-8")
    flight = Flight(plan, state_file)
    assert "does not say what flight is under way" in flight.told("restart", "")[0]
    flight.start()
    assert json.loads(state_file.read_text())["lift_off_ns"] == flight.lift_offs[0]
