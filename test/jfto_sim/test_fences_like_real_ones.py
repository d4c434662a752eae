"""Fences: what they end, forbid and keep on the ground, on `jfto_sim` as on ArduCopter."""

from __future__ import annotations

import math

import pytest

from jfto_sim.dialect import mavlink as m
from jfto_sim.geodesy import move
from jfto_sim.mission.items import Item
from support.real_or_not import AUTO, ORIGIN, RTL, Start, fly_mission, refused_with


def test_a_ceiling_turns_a_mission_home(pilots: Start):
    """FENCE_ALT_MAX: breached at its height, RTL, and the way home stays below it."""
    pilot = pilots(FENCE_ENABLE=1, FENCE_TYPE=1, FENCE_ALT_MAX=30)
    pilot.take_off(15.0)
    pilot.every(m.MAVLINK_MSG_ID_FENCE_STATUS, 0.2)
    fly_mission(pilot, (0.0, 40.0, 60.0), (0.0, 80.0, 60.0))
    pilot.wait_text("Fence Breached", 60.0)
    assert pilot.height_m == pytest.approx(30.0, abs=2.0)
    pilot.wait_mode(RTL)
    assert any(
        h.message.breach_status == 1 and h.message.breach_type == m.FENCE_BREACH_MAXALT
        for h in pilot.heard
        if h.message.get_type() == "FENCE_STATUS"
    )
    first = len(pilot.heard)
    pilot.wait_until(lambda: pilot.height_m < 5.0, 120.0)
    heights = [
        h.message.relative_alt / 1000
        for h in pilot.heard[first:]
        if h.message.get_type() == "GLOBAL_POSITION_INT"
    ]
    assert max(heights) < 34.0


def test_a_circle_turns_a_mission_home_and_calls_back_who_goes_on(pilots: Start):
    """FENCE_RADIUS: RTL at once; who goes back to AUTO outside has 10 s, then RTL again."""
    pilot = pilots(FENCE_ENABLE=1, FENCE_TYPE=2, FENCE_RADIUS=40)
    pilot.take_off(15.0)
    fly_mission(pilot, (0.0, 300.0, 15.0))
    pilot.wait_text("Fence Breached", 60.0)
    assert math.hypot(*pilot.place_m) == pytest.approx(41.0, abs=3.0)
    pilot.wait_mode(RTL)
    pilot.order(176, 1, AUTO)
    again_s = pilot.now_s
    pilot.wait_text("Fence Breached", 60.0)
    assert pilot.now_s - again_s == pytest.approx(10.0, abs=1.0)
    pilot.wait_mode(RTL)


def test_a_fence_can_only_report(pilots: Start):
    """FENCE_ACTION 0: a text, and the mission goes on."""
    pilot = pilots(FENCE_ENABLE=1, FENCE_TYPE=2, FENCE_RADIUS=40, FENCE_ACTION=0)
    pilot.take_off(15.0)
    fly_mission(pilot, (0.0, 100.0, 15.0))
    pilot.wait_text("Fence Breached", 60.0)
    pilot.wait_text("Reached command #1", 60.0)
    assert pilot.mode == AUTO


def test_figures_count_once_they_are_stored(pilots: Start):
    """A polygon to stay in, a circle to stay out of: crossing either brings the vehicle home."""
    pilot = pilots(FENCE_TYPE=4)
    pilot.take_off(15.0)
    corners = [move(*ORIGIN, e, n) for e, n in ((-90, -90), (90, -90), (90, 90), (-90, 90))]
    keep_out = Item(5004, 0, (20.0, 0, 0, 0), *move(*ORIGIN, 0.0, 60.0))
    figures = [Item(5001, 0, (4, 0, 0, 0), *corner) for corner in corners]
    assert pilot.upload([*figures, keep_out], 1) == 0
    pilot.set_parameter("FENCE_ENABLE", 1)
    fly_mission(pilot, (70.0, 0.0, 15.0), (0.0, 60.0, 15.0))
    pilot.wait_text("Reached command #1", 60.0)
    pilot.wait_text("Fence Breached", 60.0)
    east, north = pilot.place_m
    assert math.hypot(east, north - 60.0) == pytest.approx(19.0, abs=3.0)
    pilot.wait_mode(RTL)


def test_guided_is_not_sent_beyond_a_fence(pilots: Start):
    """DO_REPOSITION outside fails, a streamed place outside is not flown to; inside both are."""
    pilot = pilots(FENCE_ENABLE=1, FENCE_TYPE=3, FENCE_RADIUS=60, FENCE_ALT_MAX=40)
    pilot.take_off(15.0)

    def go(east_m: float, north_m: float, up_m: float) -> int:
        lat, lon = move(*ORIGIN, east_m, north_m)
        pilot.send(
            m.MAVLink_command_int_message(
                pilot.sysid, 1, 6, m.MAV_CMD_DO_REPOSITION, 0, 0, -1, 0, 0, 0, lat, lon, up_m
            )
        )
        ack = pilot.wait(lambda x: x.get_type() == "COMMAND_ACK" and x.command == 192)
        return int(ack.message.result)

    assert go(0.0, 100.0, 15.0) == m.MAV_RESULT_FAILED
    assert go(0.0, 20.0, 50.0) == m.MAV_RESULT_FAILED
    for _ in range(30):
        pilot.send(
            m.MAVLink_set_position_target_local_ned_message(
                0, pilot.sysid, 1, 1, 0xDF8, 100.0, 0.0, -15.0, 0, 0, 0, 0, 0, 0, 0, 0
            )
        )
        pilot.run(0.1)
    assert math.hypot(*pilot.place_m) < 2.0
    assert go(0.0, 20.0, 15.0) == m.MAV_RESULT_ACCEPTED
    pilot.wait_until(lambda: pilot.place_m[1] > 18.0, 30.0)


@pytest.mark.parametrize(("parameters", "words"), [
    ({"FENCE_RADIUS": 1.0}, "FENCE_MARGIN is less than FENCE_RADIUS"),
    ({"FENCE_ALT_MAX": -5.0}, "Invalid FENCE_ALT_MAX value"),
    ({"FENCE_ALT_MAX": 1.0, "FENCE_ALT_MIN": 0.0}, "FENCE_MARGIN too big"),
    ({"FENCE_TYPE": 4}, "Fences enabled, but none selected"),
    ({"ANGLE_MAX": 900}, "Check ANGLE_MAX"),
    ({"BATT_ARM_VOLT": 13.0}, "Battery 1 below minimum arming voltage"),
    ({"BATT_ARM_MAH": 4000}, "Battery 1 below minimum arming capacity"),
    ({"BATT_LOW_VOLT": 10.0, "BATT_CRT_VOLT": 10.5},
     "Battery 1 voltage failsafe critical >= low"),
])  # fmt: skip
def test_what_is_set_wrongly_keeps_it_on_the_ground(pilots: Start, parameters, words):
    """Said in ArduCopter's own words when it is told to arm."""
    pilot = pilots(FENCE_ENABLE=1, **parameters)
    pilot.ready()
    assert refused_with(pilot) == [f"Arm: {words}"]


def test_a_vehicle_outside_its_fence_is_not_armed(pilots: Start):
    """A figure to stay in that lies elsewhere."""
    pilot = pilots(FENCE_TYPE=4)
    pilot.ready()
    assert pilot.upload([Item(5003, 0, (50.0, 0, 0, 0), *move(*ORIGIN, 0.0, 90.0))], 1) == 0
    pilot.set_parameter("FENCE_ENABLE", 1)
    pilot.run(2.0)
    assert refused_with(pilot) == ["Arm: vehicle outside fence"]


def test_a_fence_is_waited_for(pilots: Start):
    """Before there is a position a level fence keeps every mode on the ground."""
    pilot = pilots(FENCE_ENABLE=1)
    pilot.wait_text("PreArm: Fence", 45.0)
    pilot.run(max(0.0, 30.0 - pilot.now_s))
    pilot.order(401)
    pilot.run(0.5)
    assert pilot.texts()[-1] == "PreArm: Fence enabled, need position estimate"
