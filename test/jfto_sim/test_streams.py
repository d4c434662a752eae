"""Message rates, per port, and what may be asked for at all."""

from collections import Counter

import pytest

from jfto_sim import Vehicle
from jfto_sim.dialect import mavlink as m
from support.pilot import Pilot

SET, GET, REQUEST = 511, 510, 512


@pytest.fixture
def pilot():
    pilot = Pilot(Vehicle())
    pilot.run(45.0)
    return pilot


def rates(pilot, seconds=5.0):
    return Counter(h.message.get_type() for h in pilot.run(seconds))


def interval(pilot, message_id):
    pilot.send(m.MAVLink_command_long_message(1, 1, GET, 0, message_id, 0, 0, 0, 0, 0, 0))
    return pilot.wait_type("MESSAGE_INTERVAL").message.interval_us


def test_nothing_but_heartbeats_unasked(pilot):
    """HEARTBEAT at 1 Hz and TIMESYNC every 10 s."""
    heard = rates(pilot, 20.0)
    assert heard["HEARTBEAT"] == 20
    assert heard["TIMESYNC"] == 2
    assert set(heard) <= {"HEARTBEAT", "TIMESYNC", "PARAM_VALUE"}


def test_all_streams_at_four_hertz(pilot):
    """REQUEST_DATA_STREAM 0 starts 27 messages at exactly 4 Hz, and stops them."""
    pilot.send(m.MAVLink_request_data_stream_message(1, 1, 0, 4, 1))
    pilot.run(1.0)
    heard = rates(pilot)
    assert sum(count == 20 for count in heard.values()) >= 27
    pilot.send(m.MAVLink_request_data_stream_message(1, 1, 0, 4, 0))
    pilot.run(0.5)
    assert set(rates(pilot)) <= {"HEARTBEAT", "TIMESYNC", "PARAM_VALUE"}


def test_position_stream(pilot):
    """Stream 6 holds the two position messages."""
    pilot.send(m.MAVLink_request_data_stream_message(1, 1, 6, 3, 1))
    pilot.run(1.0)
    heard = rates(pilot)
    assert heard["GLOBAL_POSITION_INT"] == heard["LOCAL_POSITION_NED"] == 15


@pytest.mark.parametrize(
    ("asked_us", "kept_us"), [(200_000, 200_000), (1000, 3000), (-1, -1), (0, -1)]
)
def test_intervals_as_asked(pilot, asked_us, kept_us):
    """Too short is 3 ms, -1 is off, 0 is the default, which is off."""
    assert pilot.command(SET, 33, asked_us) == m.MAV_RESULT_ACCEPTED
    assert interval(pilot, 33) == kept_us


def test_three_hundred_and_thirty_three_hertz(pilot):
    """The shortest interval is kept: 333 Hz."""
    pilot.command(SET, 30, 1000)
    pilot.run(0.1)
    assert rates(pilot, 3.0)["ATTITUDE"] == pytest.approx(1000, abs=2)


def test_heartbeat_itself_can_be_changed(pilot):
    """Twice a second, and 0 brings back once a second."""
    pilot.command(SET, 0, 500_000)
    pilot.run(0.5)
    assert rates(pilot, 4.0)["HEARTBEAT"] == 8
    pilot.command(SET, 0, 0)
    assert interval(pilot, 0) == 1_000_000


def test_unknown_message(pilot):
    """DENIED with a text; its interval is 0 and FAILED; a request for it FAILED."""
    assert pilot.command(SET, 9999, 100_000) == m.MAV_RESULT_DENIED
    pilot.run(0.1)
    assert pilot.texts()[-1] == "No ap_message for mavlink id (9999)"
    assert interval(pilot, 9999) == 0
    assert pilot.command(REQUEST, 12345) == m.MAV_RESULT_FAILED


@pytest.mark.parametrize(("number", "result"), [
    (31000, m.MAV_RESULT_UNSUPPORTED), (519, m.MAV_RESULT_UNSUPPORTED),
    (520, m.MAV_RESULT_FAILED), (401, m.MAV_RESULT_ACCEPTED)])  # fmt: skip
def test_other_commands(pilot, number, result):
    """Unknown commands are UNSUPPORTED; 520 without its 1 is FAILED."""
    assert pilot.command(number) == result


def test_rates_belong_to_one_port(pilot):
    """What one port asked for does not appear on another."""
    other = Pilot(pilot.vehicle, 1)
    other.run(0.2)
    other.every(m.MAVLINK_MSG_ID_GLOBAL_POSITION_INT, 0.2)
    frames = pilot.vehicle.advance(2.0)
    codec = m.MAVLink(None)
    ports = {p for p, f in frames if codec.decode(bytearray(f)).get_type() == "GLOBAL_POSITION_INT"}
    assert ports == {1}


def test_every_message_of_the_table_can_be_encoded(pilot):
    """Each message that may be asked for is answered, on the ground and in the air."""
    from jfto_sim.telemetry import MESSAGES

    for height in (0.0, 5.0):
        if height:
            pilot.take_off(height)
        for message_id in sorted(MESSAGES):
            assert pilot.command(REQUEST, message_id) == m.MAV_RESULT_ACCEPTED


def test_foreign_stations():
    """Another system's frames are ignored; SYSID_ENFORCE leaves only SYSID_MYGCS."""
    vehicle = Vehicle()
    pilot, other = Pilot(vehicle), Pilot(vehicle, system=200)
    pilot.run(5.0)
    assert other.command(REQUEST, 148) == m.MAV_RESULT_ACCEPTED
    pilot.set_parameter("SYSID_ENFORCE", 1)
    other.send(m.MAVLink_command_long_message(1, 1, REQUEST, 0, 148, 0, 0, 0, 0, 0, 0))
    assert not [h for h in other.run(1.0) if h.message.get_type() == "COMMAND_ACK"]
    pilot.send(m.MAVLink_command_long_message(9, 1, REQUEST, 0, 148, 0, 0, 0, 0, 0, 0))
    assert not [h for h in pilot.run(1.0) if h.message.get_type() == "COMMAND_ACK"]
