"""What an operator is told of flights that go well and of flights that do not."""

from __future__ import annotations

import itertools

import pytest

from jfto_mavlink.dialect import MODES
from jfto_mavlink.fleet.changes import state_changes
from jfto_mavlink.fleet.fly import Fleet, FlySettings, deliver_to_fleet, start_fleet
from jfto_mavlink.flight.control import pause, return_home
from jfto_mavlink.flight.telemetry import LinkState
from jfto_msgs_py.records.event import DEBUG, INFO
from jfto_sim import LinkFaults
from support.watched_flight import READY_S, Flight

CUT = LinkFaults(cut=True)
CLEAN = LinkFaults()


@pytest.fixture
def flight(plan):
    return Flight(plan)


@pytest.mark.slow
def test_a_flight_without_faults_is_told_from_lift_off_to_landing(flight):
    """Lift-off, all waypoints passed, each landing, the end; nothing that is bad."""
    flight.start()
    assert flight.told("lift_off", "") == ["Lift-off: uav1, uav2."]
    assert flight.until("landed", "", 300.0) == (
        "The flight is over: uav1 landed on its pad; uav2 landed on its pad."
    )
    assert flight.told("done", "uav1") == [
        "uav1 has passed all its waypoints and ends its mission."
    ]
    assert [n.kind for n in flight.notices if n.level > INFO] == []
    assert len(flight.notices) == 6


@pytest.mark.slow
def test_a_killed_vehicle_is_lost_and_the_others_fly_on(flight):
    """One line says where it was last; its waypoints are named; the flight still has an end."""
    flight.start()
    flight.runner.advance(20.0)
    flight.vehicles["uav2"].kill()
    text = flight.until("vehicle", "uav2", 20.0)
    assert text.startswith("uav2 is lost: not heard for 5 s, last in AUTO at 47.39")
    assert text.endswith("; uav1 flies on.")
    assert flight.told("unvisited", "uav2") == [
        "uav2 leaves waypoints 2, 4: nobody takes them over."
    ] or flight.told("unvisited", "uav2") == ["uav2 leaves waypoints 4: nobody takes them over."]
    end = flight.until("landed", "", 300.0)
    assert "uav1 landed on its pad; uav2 declared lost, last heard at 47.39" in end


@pytest.mark.slow
def test_a_low_battery_brings_a_vehicle_home(flight):
    """Its own failsafe does; the line says so, once."""
    flight.start()
    flight.runner.advance(10.0)
    flight.vehicles["uav1"].params.store("SIM_BATT_VOLTAGE", 10.4)
    text = flight.until("battery", "uav1", 20.0)
    assert text.startswith("uav1 says battery 1 is low 10.40V used")
    assert text.endswith("by itself it returns home; uav2 flies on.")
    assert "landed on its pad; uav2 landed on its pad" in flight.until("landed", "", 300.0)
    assert len(flight.told("battery", "uav1")) == 1


@pytest.mark.slow
def test_a_battery_without_a_failsafe_is_told_too(flight):
    """Nobody acts then, and the line says that."""
    flight.start()
    flight.vehicles["uav1"].params.store("BATT_FS_LOW_ACT", 0.0)
    flight.vehicles["uav1"].params.store("SIM_BATT_VOLTAGE", 10.4)
    text = flight.until("battery", "uav1", 30.0)
    assert "no failsafe has acted: it flies on in AUTO; uav2 flies on." in text


@pytest.mark.slow
def test_lost_gps_is_told_when_it_goes_and_when_the_vehicle_lands(flight):
    """ArduCopter lands where it is after 8 s; that is not its pad."""
    flight.start()
    flight.runner.advance(25.0)
    flight.vehicles["uav1"].params.store("SIM_GPS_DISABLE", 1.0)
    assert flight.until("gps", "uav1", 5.0) == (
        "uav1 has lost its GPS: it flies on in AUTO until its own failsafe lands it; uav2 flies on."
    )
    assert flight.runner.until(lambda: len(flight.told("gps", "uav1")) == 2, 12.0)
    assert (
        "uav1 has lost its position: by itself it lands where it is at"
        in (flight.told("gps", "uav1")[1])
    )
    end = flight.until("landed", "", 300.0)
    assert "uav1 landed" in end
    assert "m from its pad at 47.39" in end


@pytest.mark.slow
def test_a_mode_that_this_station_ordered_is_no_news(flight):
    """Pause and return are; another station's LOITER is."""
    flight.start()
    flight.runner.run({"uav1": pause})
    flight.runner.run({"uav1": return_home})
    flight.runner.advance(3.0)
    assert [n.kind for n in flight.notices] == ["lift_off"]
    flight.vehicles["uav2"].modes.set(MODES["LOITER"])
    flight.runner.advance(3.0)
    (text,) = flight.told("mode", "uav2")
    assert text == (
        "uav2 changed its mode, which nobody ordered here: by itself it is in LOITER; order abort "
        "to bring it home."
    )


@pytest.mark.slow
def test_a_vehicle_that_is_heard_again_flies_on(flight):
    """Lost for a while, then back on its mission: two lines, and it lands like the others."""
    flight.start()
    flight.runner.advance(10.0)
    flight.runner.air.set_faults(2, CUT, CUT)
    flight.until("vehicle", "uav2", 20.0)
    flight.runner.air.set_faults(2, CLEAN, CLEAN)
    assert flight.runner.until(lambda: len(flight.told("vehicle", "uav2")) == 2, 10.0)
    assert flight.told("vehicle", "uav2")[1].startswith("uav2 is heard again, in AUTO at 47.39")
    assert flight.until("landed", "", 300.0).endswith("uav2 landed on its pad.")


@pytest.mark.slow
def test_a_vehicle_that_stays_on_the_ground_is_named(flight):
    """The others' lift-off does not wait for it for ever."""
    flight.runner.advance(READY_S)
    mission = {"uav1": flight.missions["uav1"]}
    sent = {u: m.mission for u, m in flight.missions.items()}
    release = deliver_to_fleet(flight.runner, sent).release()
    one = type(release)({"uav1": release.missions["uav1"]}, {"uav1": release.digests["uav1"]})
    start_fleet(Fleet(flight.runner, mission), one, FlySettings())
    assert flight.until("lift_off", "", 20.0) == "Lift-off: uav1; uav2 stayed on the ground."


@pytest.mark.slow
def test_a_second_flight_has_a_lift_off_of_its_own(flight):
    """The end of one flight is not that of the next."""
    flight.start()
    flight.runner.run(dict.fromkeys(flight.missions, return_home))
    flight.until("landed", "", 200.0)
    first = flight.monitor.begun
    flight.events.clear()
    flight.start()
    assert flight.told("lift_off", "") == ["Lift-off: uav1, uav2."]
    assert flight.monitor.begun.at_s > first.at_s + 30.0
    assert flight.monitor.ended == {}


def test_link_loss_and_return_are_told(flight):
    """Five silent seconds on the ground are a lost link; the first heartbeat ends it."""
    flight.runner.advance(3.0)
    flight.runner.air.set_faults(1, CLEAN, CUT)
    flight.runner.advance(8.0)
    assert flight.told("link", "uav1")[-1] == "uav1 on the ground is not heard for 5 s."
    flight.runner.air.set_faults(1, CLEAN, CLEAN)
    flight.runner.advance(3.0)
    assert flight.told("link", "uav1")[-1] == "uav1 on the ground is heard again."


def test_a_station_that_slept_does_not_call_its_vehicles_lost(flight):
    """Time in which it did not listen is no silence; what comes after counts anew."""
    flight.runner.advance(3.0)
    flight.runner.now_s += 60.0
    flight.runner.advance(3.0)
    assert flight.notices == []
    flight.vehicles["uav1"].kill()
    flight.runner.advance(8.0)
    assert [(event.kind, event.uav_id) for event in flight.notices] == [("link", "uav1")]


def test_each_change_is_told_once():
    """Mode, arming, failsafe: one event each at DEBUG, none for a repetition."""
    states = [
        LinkState("uav1", 0.0),
        LinkState("uav1", 0.5, 0.1, "GUIDED"),
        LinkState("uav1", 1.0, 0.1, "GUIDED"),
        LinkState("uav1", 1.5, 0.1, "RTL", armed=True, failsafe=True),
    ]
    told = [state_changes(*pair) for pair in itertools.pairwise(states)]
    assert [[event.kind for event in events] for events in told] == [
        ["link", "mode"],
        [],
        ["mode", "armed", "failsafe"],
    ]
    assert [event.text for event in told[2]] == ["mode RTL", "armed", "failsafe"]
    assert {event.level for events in told for event in events} == {DEBUG}
