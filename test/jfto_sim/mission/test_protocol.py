"""Each row of the recorded autopilot's mission protocol table."""

import math

import pytest

from jfto_sim import Vehicle
from jfto_sim.dialect import mavlink as m
from jfto_sim.mission.items import MISSION_CAPACITY, Item
from support.pilot import Pilot

LAT, LON = 473977420, 85455940


def waypoint(n=0, height=20.0, **changes):
    return Item(
        **{"command": 16, "frame": 6, "x": LAT + 500 * n, "y": LON, "z_m": height, **changes}
    )


def mission(count):
    return [waypoint(k) for k in range(count)]


@pytest.fixture
def pilot():
    pilot = Pilot(Vehicle())
    pilot.run(21.0)
    return pilot


def kinds(heard):
    return [h.message.get_type() for h in heard]


def of_type(heard, kind):
    return [h.message for h in heard if h.message.get_type() == kind]


def count_message(count, kind=0, target=1, component=1):
    return m.MAVLink_mission_count_message(target, component, count, kind)


def test_requests_are_always_mission_request_and_quick(pilot):
    """MISSION_COUNT is answered by MISSION_REQUEST within 6 ms, and so is every item."""
    started = pilot.vehicle.time_s
    assert pilot.upload(mission(23)) == m.MAV_MISSION_ACCEPTED
    assert "MISSION_REQUEST_INT" not in kinds(pilot.heard)
    assert len(of_type(pilot.heard, "MISSION_REQUEST")) == 23
    assert pilot.vehicle.time_s - started < 23 * 0.06
    pilot.run(0.1)
    assert "Flight plan received" in pilot.texts()


def test_answer_comes_within_six_milliseconds(pilot):
    """The first request leaves 2 to 6 ms after the count."""
    pilot.send(count_message(3))
    assert not of_type(pilot.run(0.0), "MISSION_REQUEST")
    assert of_type(pilot.run(0.006), "MISSION_REQUEST")


def test_float_items_are_taken_with_one_text(pilot):
    """MISSION_ITEM is accepted; the autopilot complains once per upload."""
    pilot.send(count_message(3))
    for seq in range(3):
        pilot.wait_type("MISSION_REQUEST")
        pilot.send(
            m.MAVLink_mission_item_message(
                1, 1, seq, 6, 16, 0, 1, 0, 0, 0, 0, LAT * 1e-7, LON * 1e-7, 20.0, 0
            )
        )
    assert pilot.wait_type("MISSION_ACK").message.type == m.MAV_MISSION_ACCEPTED
    pilot.run(0.1)
    note = "got MISSION_ITEM; GCS should send MISSION_ITEM_INT"
    assert pilot.texts().count(note) == 1


def test_silence_is_asked_every_second_and_given_up_after_eight(pilot):
    """The request is repeated each second; 8 s after the last item the upload is cancelled."""
    pilot.send(count_message(5))
    pilot.wait_type("MISSION_REQUEST")
    pilot.send(pilot.item_message(waypoint(), 0))
    begun = pilot.vehicle.time_s
    heard = pilot.run(9.0)
    requests = [h.time_s for h in heard if h.message.get_type() == "MISSION_REQUEST"]
    assert len(requests) == 8
    assert [round(t - requests[0]) for t in requests] == list(range(8))
    (ack,) = [h for h in heard if h.message.get_type() == "MISSION_ACK"]
    assert ack.message.type == m.MAV_MISSION_OPERATION_CANCELLED
    assert ack.time_s - begun == pytest.approx(8.0, abs=0.1)
    assert "Mission upload timeout" in pilot.texts()


@pytest.mark.parametrize("silence_s", [5.5, 7.5])
def test_a_long_silence_is_forgiven(pilot, silence_s):
    """5.5 or 7.5 s without an answer, then the right item: the upload goes on."""
    pilot.send(count_message(2))
    pilot.run(silence_s)
    pilot.send(pilot.item_message(waypoint(), 0))
    heard = pilot.wait(lambda x: x.get_type() == "MISSION_REQUEST" and x.seq == 1)
    assert heard.message.seq == 1


def test_wrong_sequence_is_not_fatal(pilot):
    """An item out of order earns INVALID_SEQUENCE without a new request; the upload stays open."""
    pilot.send(count_message(3))
    pilot.wait_type("MISSION_REQUEST")
    for seq in (2, 0, 0):
        pilot.send(pilot.item_message(waypoint(seq), seq))
    heard = pilot.run(0.5)
    assert [a.type for a in of_type(heard, "MISSION_ACK")] == [m.MAV_MISSION_INVALID_SEQUENCE] * 2
    assert [r.seq for r in of_type(heard, "MISSION_REQUEST")] == [1]
    pilot.send(pilot.item_message(waypoint(1), 1))
    assert pilot.wait_type("MISSION_REQUEST").message.seq == 2


def test_burst_loses_nothing(pilot):
    """All items at once without waiting are accepted."""
    pilot.send(count_message(9))
    for seq, item in enumerate(mission(9)):
        pilot.send(pilot.item_message(item, seq))
    assert pilot.wait_type("MISSION_ACK").message.type == m.MAV_MISSION_ACCEPTED
    assert len(pilot.download()) == 9


def test_lost_final_ack_is_not_repeated(pilot):
    """The last item again after the end gives ERROR: there is no upload any more."""
    pilot.upload(mission(3))
    pilot.send(pilot.item_message(waypoint(2), 2))
    assert pilot.wait_type("MISSION_ACK").message.type == m.MAV_MISSION_ERROR


def test_second_count_of_the_same_station_starts_over(pilot):
    """The new count wins and requests begin at 0."""
    pilot.send(count_message(9))
    pilot.wait_type("MISSION_REQUEST")
    pilot.send(pilot.item_message(waypoint(), 0))
    pilot.run(0.1)
    assert pilot.upload(mission(5)) == m.MAV_MISSION_ACCEPTED
    assert pilot.vehicle.store.count(0) == 5


@pytest.mark.parametrize(("system", "component"), [(254, 190), (255, 191)])
def test_another_station_is_denied(pilot, system, component):
    """Count and item of another system or component are DENIED; the upload goes on."""
    other = Pilot(pilot.vehicle, system=system, component=component)
    other.beating = False
    pilot.send(count_message(3))
    pilot.run(0.1)
    other.send(count_message(3))
    other.send(other.item_message(waypoint(), 0))
    acks = of_type(other.run(0.1), "MISSION_ACK")
    assert [a.type for a in acks] == [m.MAV_MISSION_DENIED] * 2
    assert {(a.target_system, a.target_component) for a in acks} == {(system, component)}
    assert pilot.vehicle.mission_protocol.uploads


def test_other_requests_during_an_upload(pilot):
    """REQUEST_LIST and REQUEST_INT are DENIED, CLEAR_ALL is an ERROR; the upload goes on."""
    pilot.send(count_message(3))
    pilot.run(0.1)
    pilot.send(m.MAVLink_mission_request_list_message(1, 1, 0))
    pilot.send(m.MAVLink_mission_request_int_message(1, 1, 0, 0))
    pilot.send(m.MAVLink_mission_clear_all_message(1, 1, 0))
    acks = [a.type for a in of_type(pilot.run(0.1), "MISSION_ACK")]
    assert acks == [m.MAV_MISSION_DENIED, m.MAV_MISSION_DENIED, m.MAV_MISSION_ERROR]
    assert pilot.vehicle.mission_protocol.uploads


def test_too_many_items(pilot):
    """NO_SPACE at once, with the limit in words, and no upload."""
    assert pilot.upload(mission(MISSION_CAPACITY + 1)) == m.MAV_MISSION_NO_SPACE
    pilot.run(0.1)
    assert f"Only {MISSION_CAPACITY} items are supported" in pilot.texts()
    assert not pilot.vehicle.mission_protocol.uploads


def test_count_zero_empties(pilot):
    """ACCEPTED at once, the mission is empty, item 0 can still be read."""
    pilot.upload(mission(4))
    assert pilot.upload([]) == m.MAV_MISSION_ACCEPTED
    assert pilot.vehicle.store.count(0) == 0
    pilot.send(m.MAVLink_mission_request_int_message(1, 1, 0, 0))
    assert pilot.wait_type("MISSION_ITEM_INT").message.command == 16


@pytest.mark.parametrize(
    ("target", "component", "answered"), [(2, 1, False), (0, 1, True), (0, 0, True), (1, 99, True)]
)
def test_addressing(pilot, target, component, answered):
    """Another system is ignored; system 0 and any component count as the vehicle's own."""
    pilot.send(count_message(3, target=target, component=component))
    assert bool(of_type(pilot.run(0.1), "MISSION_REQUEST")) is answered


def test_item_for_another_system_is_ignored(pilot):
    """Inside a valid upload such an item changes nothing; the request comes again after 1 s."""
    pilot.send(count_message(3))
    pilot.run(0.1)
    stray = pilot.item_message(waypoint(), 0)
    stray.target_system = 2
    pilot.send(stray)
    assert not of_type(pilot.run(0.5), "MISSION_ACK")
    assert [r.seq for r in of_type(pilot.run(0.6), "MISSION_REQUEST")] == [0]


def test_partial_write(pilot):
    """Only the named range is asked for and replaced; past the end it is refused."""
    pilot.upload(mission(9))
    pilot.send(m.MAVLink_mission_write_partial_list_message(1, 1, 2, 3, 0))
    for seq in (2, 3):
        assert pilot.wait_type("MISSION_REQUEST").message.seq == seq
        pilot.send(pilot.item_message(waypoint(seq, 33.0), seq))
    assert pilot.wait_type("MISSION_ACK").message.type == m.MAV_MISSION_ACCEPTED
    assert [i.z for i in pilot.download()[1:5]] == [20.0, 33.0, 33.0, 20.0]
    pilot.send(m.MAVLink_mission_write_partial_list_message(1, 1, 20, 30, 0))
    assert pilot.wait_type("MISSION_ACK").message.type == m.MAV_MISSION_ERROR
    pilot.run(0.1)
    assert "Flight plan update rejected" in pilot.texts()


def test_a_refused_upload_is_not_undone(pilot):
    """Refused at item 2 of 4: new items 0 and 1, old items 2 and 3, four in all."""
    pilot.upload(mission(9))
    changed = [waypoint(k, 50.0) for k in range(4)]
    changed[2] = waypoint(2, x=910000000)
    assert pilot.upload(changed) == m.MAV_MISSION_INVALID_PARAM5_X
    assert [i.z for i in pilot.download()[1:]] == [50.0, 20.0, 20.0]


def test_read_past_the_end(pilot):
    """MISSION_COUNT and MISSION_ACK ERROR."""
    pilot.upload(mission(3))
    pilot.send(m.MAVLink_mission_request_int_message(1, 1, 3, 0))
    heard = pilot.run(0.1)
    assert of_type(heard, "MISSION_COUNT")[0].count == 3
    assert of_type(heard, "MISSION_ACK")[0].type == m.MAV_MISSION_ERROR


def test_old_style_read_is_answered_in_kind(pilot):
    """MISSION_REQUEST gets a float MISSION_ITEM and one text."""
    pilot.upload(mission(3))
    for seq in range(3):
        pilot.send(m.MAVLink_mission_request_message(1, 1, seq, 0))
    heard = pilot.run(0.1)
    assert len(of_type(heard, "MISSION_ITEM")) == 3
    assert pilot.texts().count("got MISSION_REQUEST; use MISSION_REQUEST_INT!") == 1


def test_item_zero_is_home(pilot):
    """Whatever is sent as seq 0 reads back as home in frame 0."""
    pilot.upload([Item(22, 6, x=1, y=2, z_m=99.0), waypoint(1)])
    home = pilot.download()[0]
    assert (home.command, home.frame, home.x, home.y) == (16, 0, LAT, LON)
    assert home.z == pytest.approx(488.1, abs=0.01)


def test_clear_all_types(pilot):
    """Each type is cleared by itself; 255 is UNSUPPORTED."""
    pilot.upload(mission(3))
    for kind, expected in ((0, 0), (1, 0), (2, 0), (255, m.MAV_MISSION_UNSUPPORTED)):
        pilot.send(m.MAVLink_mission_clear_all_message(1, 1, kind))
        assert pilot.wait_type("MISSION_ACK").message.type == expected
    assert pilot.vehicle.store.count(0) == 0


def test_set_current(pilot):
    """A valid seq is answered by MISSION_CURRENT at once, 0 means 1, past the end is silence."""
    pilot.upload(mission(9))
    for seq, expected in ((3, [3]), (50, []), (0, [1])):
        pilot.send(m.MAVLink_mission_set_current_message(1, 1, seq))
        assert [c.seq for c in of_type(pilot.run(0.1), "MISSION_CURRENT")] == expected
    assert pilot.command(224, 99) == m.MAV_RESULT_DENIED
    assert pilot.command(224, 4) == m.MAV_RESULT_ACCEPTED


def test_fence_and_rally_round_trip(pilot):
    """A polygon and a rally point are stored and read back; two corners are refused."""
    corners = [Item(5001, 0, (4, 0, 0, 0), LAT + 9000 * a, LON + 9000 * b) for a, b in
               ((-1, -1), (1, -1), (1, 1), (-1, 1))]  # fmt: skip
    assert pilot.upload(corners, 1) == m.MAV_MISSION_ACCEPTED
    assert [(i.command, i.x, i.y) for i in pilot.download(1)] == [(5001, c.x, c.y) for c in corners]
    assert pilot.upload([Item(5100, 3, x=LAT, y=LON, z_m=30.0)], 2) == m.MAV_MISSION_ACCEPTED
    assert [i.z for i in pilot.download(2)] == [30.0]
    two = [Item(5001, 0, (2, 0, 0, 0), LAT, LON)] * 2
    assert pilot.upload(two, 1) == m.MAV_MISSION_ERROR
    pilot.run(0.1)
    assert {"Fence Indexed OK", "Invalid vertex count (2)"} <= set(pilot.texts())


def test_mavlink1_port_refuses_fences():
    """On a port set to MAVLink 1 a mission goes through, a fence does not."""
    pilot = Pilot(Vehicle())
    pilot.run(3.0)
    pilot.set_parameter("SERIAL0_PROTOCOL", 1)
    pilot.vehicle.reboot()
    pilot.run(3.0)
    assert pilot.vehicle.ports[0].mavlink1
    assert pilot.upload(mission(3)) == m.MAV_MISSION_ACCEPTED
    pilot.send(count_message(4, kind=1))
    assert pilot.wait_type("MISSION_ACK").message.type == m.MAV_MISSION_UNSUPPORTED
    pilot.run(0.1)
    assert "Need mavlink2 for item transfer" in pilot.texts()
    assert math.isclose(pilot.vehicle.params["MIS_TOTAL"], 3)
