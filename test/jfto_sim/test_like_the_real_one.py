"""What a real vehicle refuses, and does by itself: the same on `jfto_sim` and on ArduCopter."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

from jfto_sim.config import fleet
from jfto_sim.dialect import mavlink as m
from support.real_or_not import GUIDED, LAND, RTL, Start, fly_mission, refused_with
from support.vehicles import Starter

# --- time, battery ---


@pytest.mark.parametrize("delay_s", [10, 20])
def test_an_armed_vehicle_that_stays_disarms_by_its_own_clock(pilots: Start, delay_s):
    """DISARM_DELAY counts the vehicle's seconds, however fast they pass."""
    pilot = pilots(DISARM_DELAY=delay_s)
    pilot.ready()
    pilot.order(176, 1, GUIDED)
    pilot.order(400, 1)
    armed_s = pilot.now_s
    pilot.wait_text("Disarming motors", 30.0)
    assert pilot.now_s - armed_s == pytest.approx(delay_s, abs=1.5)


def test_a_battery_is_used_up(pilots: Start):
    """About 28 A in the hover of BATT_CAPACITY 3300 mAh: 14 % in a minute; more in a climb."""
    pilot = pilots()
    pilot.take_off(10.0)
    before, began_s = pilot.charge_percent, pilot.now_s
    hover_a = pilot.last("SYS_STATUS").current_battery / 100
    pilot.run(60.0)
    minutes = (pilot.now_s - began_s) / 60
    assert (before - pilot.charge_percent) / minutes == pytest.approx(14.2, abs=1.5)
    fly_mission(pilot, (0.0, 0.0, 40.0))
    pilot.wait_until(lambda: pilot.height_m > 20.0, 30.0)
    assert pilot.last("SYS_STATUS").current_battery / 100 > hover_a + 1.5


def test_a_battery_short_of_charge_calls_home(pilots: Start):
    """BATT_LOW_MAH left, without a delay: said, RTL; and no arming after the landing."""
    pilot = pilots(BATT_LOW_MAH=3000, BATT_FS_LOW_ACT=2)
    pilot.take_off(10.0)
    pilot.wait_text("Battery 1 is low", 60.0)
    pilot.wait_mode(RTL)
    pilot.wait(lambda x: x.get_type() == "HEARTBEAT" and not x.base_mode & 128, 90.0)
    assert "Arm: Battery 1 low capacity failsafe" in refused_with(pilot)


def test_a_low_voltage_must_last(pilots: Start):
    """BATT_LOW_TIMER seconds below BATT_LOW_VOLT, in flight: then LAND as asked."""
    pilot = pilots(BATT_LOW_VOLT=11.5, BATT_FS_LOW_ACT=1)
    pilot.take_off(10.0)
    pilot.set_parameter("SIM_BATT_VOLTAGE", 11.3)
    low_s = pilot.now_s
    pilot.wait_text("Battery 1 is low 11.30V", 30.0)
    assert pilot.now_s - low_s == pytest.approx(10.0, abs=1.5)
    pilot.wait_mode(LAND)


def test_a_vehicle_that_lost_its_station_is_not_armed(pilots: Start):
    """FS_GCS_ENABLE 1: said on the ground too, and armed only once the heartbeats are back."""
    pilot = pilots(FS_GCS_ENABLE=1)
    pilot.ready()
    pilot.beating = False
    pilot.wait_text("GCS Failsafe", 15.0)
    assert "Arm: GCS failsafe on" in refused_with(pilot)
    pilot.beating = True
    pilot.wait_text("GCS Failsafe Cleared", 10.0)
    pilot.order(400, 1)


# --- wind ---


def test_a_head_wind_makes_late(pilots: Start):
    """At 10 m/s through the air the tilt limit is reached: 8 m/s against it leave 3 to 6 m/s."""
    pilot = pilots(SIM_WIND_T=1, SIM_WIND_DIR=0)
    pilot.take_off(20.0)
    pilot.set_parameter("SIM_WIND_SPD", 8.0)
    pilot.run(10.0)
    fly_mission(pilot, (0.0, 200.0, 20.0))
    pilot.wait_until(lambda: pilot.place_m[1] > 30.0, 60.0)
    assert 2.0 < pilot.speed_mps < 6.0


def test_a_wind_beyond_the_tilt_limit_carries_it_away(pilots: Start):
    """ANGLE_MAX 20° holds 7.4 m/s of air: in 12 m/s nobody stays where he is."""
    pilot = pilots(SIM_WIND_T=1, SIM_WIND_DIR=0, ANGLE_MAX=2000)
    pilot.take_off(20.0)
    pilot.set_parameter("SIM_WIND_SPD", 12.0)
    pilot.wait_until(lambda: pilot.place_m[1] < -40.0, 60.0)


def test_a_copter_does_not_know_the_wind(pilots: Start):
    """It leans into 8 m/s and holds its place, and its WIND message says 0 m/s from the south."""
    pilot = pilots(SIM_WIND_T=1, SIM_WIND_DIR=270, SIM_WIND_SPD=8)
    pilot.take_off(15.0)
    pilot.every(m.MAVLINK_MSG_ID_WIND, 0.5)
    pilot.run(10.0)
    assert math.hypot(*pilot.place_m) < 3.0
    told = pilot.last("WIND")
    assert (told.speed, abs(told.direction)) == (0.0, 180.0)


def test_a_level_fence_says_that_it_has_lost_its_place(pilots: Start):
    """16 s without GPS in a mode that needs none."""
    pilot = pilots(FENCE_ENABLE=1)
    pilot.ready()
    pilot.set_parameter("SIM_GPS_DISABLE", 1)
    pilot.run(16.5)
    first = len(pilot.texts())
    pilot.order(401)
    pilot.run(0.5)
    said = [text for text in pilot.texts()[first:] if text.startswith("PreArm")]
    assert said == ["PreArm: GPS 1: Bad fix", "PreArm: Fence requires position"]


# --- the way home ---


def test_the_way_home(pilots: Start):
    """Up to RTL_ALT first, RTL_LOIT_TIME over home, down at LAND_SPEED, motors off."""
    pilot = pilots(RTL_ALT=3000, RTL_LOIT_TIME=10000, RTL_CONE_SLOPE=0)
    pilot.take_off(12.0)
    fly_mission(pilot, (0.0, 60.0, 12.0))
    pilot.wait_text("Reached command #1", 60.0)
    pilot.order(176, 1, RTL)
    pilot.wait_until(lambda: pilot.height_m > 28.5, 30.0)
    assert pilot.place_m[1] == pytest.approx(60.0, abs=3.0)
    pilot.wait_until(lambda: math.hypot(*pilot.place_m) < 2.0, 40.0)
    over_s = pilot.now_s
    pilot.wait_until(lambda: pilot.height_m < 28.5, 40.0)
    assert pilot.now_s - over_s == pytest.approx(14.0, abs=4.0)
    pilot.wait_until(lambda: pilot.height_m < 5.0, 60.0)
    low_s, low_m = pilot.now_s, pilot.height_m
    pilot.wait_until(lambda: pilot.height_m < 1.5, 30.0)
    assert (low_m - pilot.height_m) / (pilot.now_s - low_s) == pytest.approx(0.5, abs=0.08)
    pilot.wait(lambda x: x.get_type() == "HEARTBEAT" and not x.base_mode & 128, 30.0)


def test_the_way_home_may_end_in_the_air(pilots: Start):
    """RTL_ALT_FINAL above 0: it comes down to it and stays, armed."""
    pilot = pilots(RTL_ALT_FINAL=600)
    pilot.take_off(15.0)
    pilot.order(176, 1, RTL)
    pilot.wait_until(lambda: pilot.height_m < 7.0, 60.0)
    pilot.run(15.0)
    assert pilot.height_m == pytest.approx(6.0, abs=0.7)
    assert pilot.armed
    assert pilot.mode == RTL


# --- parameters, links ---


def test_parameters_are_stored_unchecked_and_unknown_ones_not_answered(pilots: Start):
    """Any value is taken as it comes; a name that it doesn't have, nobody hears of again."""
    pilot = pilots()
    for value in (1e9, -5.0):
        pilot.set_parameter("WPNAV_SPEED", value)
        assert pilot.parameter("WPNAV_SPEED") == pytest.approx(value)
    first = len(pilot.heard)
    pilot.send(m.MAVLink_param_set_message(pilot.sysid, 1, b"WPNAV_NOTHING", 1.0, 9))
    pilot.send(m.MAVLink_param_request_read_message(pilot.sysid, 1, b"WPNAV_NOTHING", -1))
    pilot.run(3.0)
    said = [h.message for h in pilot.heard[first:] if h.message.get_type() == "PARAM_VALUE"]
    assert "WPNAV_NOTHING" not in {x.param_id for x in said}


def test_unsigned_words_are_ignored_but_its_own_go_on(pilots: Start):
    """Once it has a key: no answer on its second port, while its heartbeats come, signed."""
    pilot = pilots()
    pilot.last("HEARTBEAT")
    key = list(range(1, 33))
    pilot.send(m.MAVLink_setup_signing_message(pilot.sysid, 1, key, 0))
    pilot.run(2.0)
    first = len(pilot.heard)
    pilot.send(m.MAVLink_param_request_read_message(pilot.sysid, 1, b"RTL_ALT", -1))
    pilot.run(3.0)
    heard = [h.message for h in pilot.heard[first:]]
    assert not [x for x in heard if x.get_type() == "PARAM_VALUE" and x.param_id == "RTL_ALT"]
    beats = [x for x in heard if x.get_type() == "HEARTBEAT"]
    assert beats
    assert all(x.get_header().incompat_flags & 1 for x in beats)


def test_two_vehicles_may_say_that_they_are_one(vehicles: Starter):
    """Same system id, other identity: nothing in the vehicles keeps them from it."""
    same = [replace(c, sysid=1, uid2=tuple(c.identity)) for c in fleet(2, spacing_m=30.0)]
    both = vehicles(same)
    found = set()
    for number in (1, 2):
        pilot = both.pilot(number)
        assert pilot.last("HEARTBEAT").get_srcSystem() == 1
        pilot.order(512, m.MAVLINK_MSG_ID_AUTOPILOT_VERSION)
        found.add(tuple(pilot.last("AUTOPILOT_VERSION").uid2))
    assert len(found) == 2


def test_a_stream_that_ends_leaves_it_hovering(pilots: Start):
    """GUIDED, GUID_TIMEOUT seconds after the last velocity: at rest, still GUIDED, nobody told."""
    pilot = pilots(GUID_TIMEOUT=2)
    pilot.take_off(15.0)
    for _ in range(60):
        pilot.send(
            m.MAVLink_set_position_target_local_ned_message(
                0, pilot.sysid, 1, 1, 0xDC7, 0, 0, 0, 4.0, 0.0, 0.0, 0, 0, 0, 0, 0
            )
        )
        pilot.run(0.1)
    assert pilot.speed_mps > 3.0
    texts = len(pilot.texts())
    pilot.run(8.0)
    assert pilot.speed_mps < 0.5
    assert pilot.mode == GUIDED
    assert len(pilot.texts()) == texts
