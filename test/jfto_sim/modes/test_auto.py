"""AUTO: starting, resuming, items behind waypoints, delays, uploads in the air."""

from itertools import pairwise

import pytest

from jfto_sim import Vehicle, VehicleConfig
from jfto_sim.dialect import mavlink as m
from jfto_sim.geodesy import move
from jfto_sim.mission.items import Item
from support.pilot import Pilot

ORIGIN = (473977420, 85455940)
HOME = Item(16, 0, x=ORIGIN[0], y=ORIGIN[1])


def waypoint(east, north, up=20.0, hold=0.0):
    lat, lon = move(*ORIGIN, east, north)
    return Item(16, 6, (hold, 0, 0, 0), lat, lon, up)


def do(command, *params, x=0):
    return Item(command, 2, (*params, *([0.0] * (4 - len(params)))), x)


TAKEOFF = Item(22, 6, z_m=20.0)


@pytest.fixture
def pilot():
    pilot = Pilot(Vehicle(VehicleConfig(parameters={"CAM1_TYPE": 1})))
    pilot.ready()
    return pilot


@pytest.fixture
def flying():
    pilot = Pilot(Vehicle(VehicleConfig(parameters={"CAM1_TYPE": 1})))
    pilot.take_off(20.0)
    return pilot


def start(pilot, items):
    assert pilot.upload([HOME, *items]) == m.MAV_MISSION_ACCEPTED
    assert pilot.command(300) == m.MAV_RESULT_ACCEPTED


def reached(pilot):
    return [h.message.seq for h in pilot.heard if h.message.get_type() == "MISSION_ITEM_REACHED"]


def times(pilot, text):
    return [h.time_s for h in pilot.heard
            if h.message.get_type() == "STATUSTEXT" and h.message.text == text]  # fmt: skip


def until(pilot, text, limit_s=120.0):
    pilot.wait(lambda x: x.get_type() == "STATUSTEXT" and x.text == text, limit_s)


def test_arming_in_auto_is_refused(pilot):
    """AUTO is not armable on the ground."""
    pilot.upload([HOME, TAKEOFF, waypoint(0, 30)])
    pilot.command(176, 1, 3)
    assert pilot.command(400, 1) == m.MAV_RESULT_FAILED
    pilot.run(0.1)
    assert "Arm: AUTO mode not armable" in pilot.texts()


def test_set_mode_auto_does_not_lift_off(pilot):
    """Armed on the ground, AUTO without MISSION_START stays down and disarms after 10 s."""
    pilot.upload([HOME, TAKEOFF, waypoint(0, 30)])
    pilot.command(176, 1, 4)
    pilot.command(400, 1)
    pilot.command(176, 1, 3)
    pilot.run(11.0)
    assert pilot.vehicle.body.landed
    assert not pilot.vehicle.flight.motors.armed
    assert pilot.texts().count("Mission: 1 Takeoff") == 2


def test_mission_without_takeoff_is_refused_on_the_ground(pilot):
    """FAILED with both texts; in the air the same mission is taken."""
    pilot.upload([HOME, waypoint(0, 30), waypoint(0, 60)])
    pilot.command(176, 1, 4)
    pilot.command(400, 1)
    assert pilot.command(300) == m.MAV_RESULT_FAILED
    pilot.run(0.1)
    assert pilot.texts()[-2:] == [
        "Auto: Missing Takeoff Cmd",
        "Mode change to AUTO failed: init failed",
    ]


def test_takeoff_time(pilot):
    """Armed long before, the takeoff item is done 4.0 s + height / 2.5 after the start."""
    pilot.command(176, 1, 4)
    pilot.command(400, 1)
    pilot.run(6.0)
    start(pilot, [TAKEOFF, waypoint(0, 30)])
    begun = pilot.vehicle.time_s
    until(pilot, "Mission: 2 WP")
    assert pilot.vehicle.time_s - begun == pytest.approx(12.0, abs=0.5)


def test_a_vehicle_that_hesitates_lifts_off_later(pilot):
    """The start order is accepted at once; the same takeoff is done that much later."""
    slow = Pilot(Vehicle(VehicleConfig(hesitation_s=4.0)))
    slow.ready()
    done = []
    for each in (pilot, slow):
        each.command(176, 1, 4)
        each.command(400, 1)
        each.run(6.0)
        start(each, [TAKEOFF, waypoint(0, 30)])
        begun = each.vehicle.time_s
        until(each, "Mission: 2 WP")
        done.append(each.vehicle.time_s - begun)
    assert done[1] - done[0] == pytest.approx(4.0, abs=0.05)


def test_reached_number_may_be_that_of_the_next_item(flying):
    """Before 178 and 205 the waypoint's own number is replaced, before 203 and 115 it is kept."""
    start(flying, [waypoint(0, 30), do(178, 1, 8), waypoint(0, 60), do(203, x=1), waypoint(0, 90),
                   do(205, -45), waypoint(0, 120), do(115, 90), waypoint(0, 150)])  # fmt: skip
    until(flying, "Reached command #9")
    assert [s for s in reached(flying) if s != 8] == [2, 3, 6, 7, 9]
    assert {"Reached command #1", "Reached command #5"} <= set(flying.texts())


def test_shutter_gives_camera_feedback_at_once(flying):
    """203 behind a waypoint: one CAMERA_FEEDBACK at the time of "reached", within a step."""
    start(flying, [waypoint(0, 40), do(203, x=1), waypoint(0, 80)])
    shot = flying.wait_type("CAMERA_FEEDBACK", 60.0)
    assert shot.message.img_idx == 1
    flying.run(0.1)
    assert shot.time_s - times(flying, "Reached command #1")[0] < 0.06


def test_items_behind_an_unfinished_yaw_are_dropped(flying):
    """A yaw at 5 degrees per second is not done at the next waypoint: no photo at all."""
    start(flying, [waypoint(0, 30), do(115, 180, 5, 1), do(203, x=1), waypoint(0, 60),
                   waypoint(0, 90)])  # fmt: skip
    until(flying, "Reached command #5")
    kinds = {h.message.get_type() for h in flying.heard}
    assert "CAMERA_FEEDBACK" not in kinds
    assert not any("DigiCamCtrl" in text for text in flying.texts())


def test_yaw_first_shutter_waits_for_the_turn(flying):
    """WP, yaw, shutter: the picture is taken when the turn is done, seconds behind the waypoint."""
    start(flying, [waypoint(0, 40), do(115, 137, 0, 1), do(203, x=1), waypoint(0, 140)])
    shot = flying.wait_type("CAMERA_FEEDBACK", 60.0)
    late = shot.time_s - times(flying, "Reached command #1")[0]
    assert late == pytest.approx(2.6, abs=0.6)


def test_camera_items_cost_no_time(flying):
    """Shutter, mount and yaw between waypoints do not slow the flight."""
    plain = [waypoint(0, 60), waypoint(60, 60), waypoint(60, 120)]
    begun = flying.vehicle.time_s
    start(flying, plain)
    until(flying, "Reached command #3")
    first = flying.vehicle.time_s - begun
    other = Pilot(Vehicle(VehicleConfig(parameters={"CAM1_TYPE": 1})))
    other.take_off(20.0)
    begun = other.vehicle.time_s
    start(
        other, [plain[0], do(203, x=1), do(205, -45), do(115, 90), plain[1], do(203, x=1), plain[2]]
    )
    until(other, "Reached command #7")
    assert other.vehicle.time_s - begun == pytest.approx(first, abs=0.5)


def test_hold_is_reached_after_the_hold(flying):
    """A waypoint with 3 s of hold costs them and a full stop."""
    start(flying, [waypoint(0, 40, hold=3), waypoint(0, 80)])
    until(flying, "Reached command #1")
    assert abs(flying.vehicle.body.velocity_mps[1]) < 0.3
    assert flying.vehicle.body.position_m[1] == pytest.approx(40.0, abs=0.5)


def test_delay_by_seconds_and_by_utc(flying):
    """NAV_DELAY waits param1 seconds, or until a second of the UTC minute, to 50 ms."""
    start(flying, [waypoint(0, 20), do(93, 5), waypoint(0, 40), do(93, -1, -1, -1, 30),
                   waypoint(0, 60)])  # fmt: skip
    until(flying, "Mission: 3 WP")
    assert times(flying, "Mission: 3 WP")[0] - times(flying, "Delaying 5 sec")[0] == pytest.approx(
        5.0, abs=0.1
    )
    until(flying, "Mission: 5 WP")
    gate = flying.vehicle.utc_us / 1e6 % 60.0
    assert gate == pytest.approx(30.0, abs=0.06)


def test_jump_is_counted(flying):
    """DO_JUMP runs the given number of times and is not reported."""
    start(flying, [waypoint(0, 10), waypoint(0, 20), do(177, 1, 2), waypoint(0, 30)])
    until(flying, "Reached command #4", 200.0)
    assert [t for t in flying.texts() if "Jump" in t] == [
        "Mission: 3 Jump 1/2",
        "Mission: 3 Jump 2/2",
    ]
    assert reached(flying) == [1, 2, 1, 2, 1, 2, 4]


def test_resume_restart_and_new_mission(flying):
    """AUTO goes on where it was left; MIS_RESTART 1 begins anew; a new mission keeps the index."""
    course = [waypoint(0, 20), waypoint(0, 40), waypoint(0, 60), waypoint(0, 200)]
    start(flying, course)
    until(flying, "Mission: 3 WP")
    flying.command(176, 1, 4)
    assert flying.upload([HOME, *course, waypoint(50, 50)]) == m.MAV_MISSION_ACCEPTED
    flying.command(176, 1, 3)
    flying.run(0.1)
    assert flying.texts()[-1] == "Mission: 3 WP"
    flying.command(176, 1, 4)
    flying.set_parameter("MIS_RESTART", 1)
    flying.command(176, 1, 3)
    flying.run(0.1)
    assert flying.texts()[-1] == "Mission: 1 WP"


def test_upload_during_auto_restarts_the_item(flying):
    """Each stored item restarts the leg; a shorter mission makes its last item current."""
    course = [waypoint(0, 20 * k) for k in range(1, 8)]
    start(flying, course)
    until(flying, "Mission: 5 WP")
    before = flying.texts().count("Auto mission changed, restarted command")
    assert flying.upload([HOME, *course[:2]]) == m.MAV_MISSION_ACCEPTED
    flying.run(0.1)
    changed = flying.texts().count("Auto mission changed, restarted command") - before
    assert changed == 4
    assert flying.vehicle.auto.runner.nav == 2
    assert flying.vehicle.mode.number == 3


def test_clear_is_refused_in_auto_only(flying):
    """MISSION_CLEAR_ALL is an ERROR in AUTO and works in GUIDED."""
    start(flying, [waypoint(0, 100)])
    for mode, expected in ((3, m.MAV_MISSION_ERROR), (4, m.MAV_MISSION_ACCEPTED)):
        flying.command(176, 1, mode)
        flying.send(m.MAVLink_mission_clear_all_message(1, 1, 0))
        assert flying.wait_type("MISSION_ACK").message.type == expected


def test_pause_and_continue(flying):
    """0 stops within 5 s (state 4), 1 goes on (state 3), other values are DENIED."""
    flying.every(m.MAVLINK_MSG_ID_MISSION_CURRENT, 0.2)
    start(flying, [waypoint(0, 300)])
    flying.run(10.0)
    assert flying.command(193, 0) == m.MAV_RESULT_ACCEPTED
    flying.run(5.0)
    assert abs(flying.vehicle.body.velocity_mps[1]) < 0.4
    assert flying.wait_type("MISSION_CURRENT").message.mission_state == 4
    assert flying.command(193, 1) == m.MAV_RESULT_ACCEPTED
    flying.run(6.0)
    assert flying.vehicle.body.velocity_mps[1] > 7.0
    assert flying.command(193, 5) == m.MAV_RESULT_DENIED


def test_mission_ends_hovering_and_starts_again(flying):
    """After the last waypoint: mode AUTO, state 5; MISSION_START begins at 1."""
    flying.every(m.MAVLINK_MSG_ID_MISSION_CURRENT, 0.2)
    start(flying, [waypoint(0, 20), waypoint(0, 30)])
    until(flying, "Reached command #2")
    flying.run(1.0)
    assert flying.wait_type("MISSION_CURRENT").message.mission_state == 5
    assert flying.vehicle.mode.number == 3
    flying.command(300)
    flying.run(0.1)
    assert flying.texts()[-1] == "Mission: 1 WP"


def test_rtl_item_lands_and_disarms(flying):
    """The RTL item is flown in AUTO; reached comes after touchdown, then disarming."""
    start(flying, [waypoint(0, 20), Item(20)])
    until(flying, "Disarming motors", 120.0)
    flying.run(0.5)
    assert reached(flying)[-1] == 2
    assert flying.vehicle.mode.number == 3
    assert flying.vehicle.body.position_m == pytest.approx((0, 0, 0), abs=0.1)


def test_terrain_item_flies_into_the_ground_or_home(flying):
    """Without data a terrain frame sinks towards sea level; with TERRAIN_ENABLE 0 it is RTL."""
    low = Item(16, 11, x=waypoint(0, 500).x, y=waypoint(0, 500).y, z_m=50.0)
    start(flying, [low])
    flying.run(5.0)
    assert flying.vehicle.body.velocity_mps[2] < -0.5
    flying.command(176, 1, 4)
    flying.set_parameter("TERRAIN_ENABLE", 0)
    flying.command(176, 1, 3)
    flying.run(0.2)
    assert "Failsafe: Terrain data missing" in flying.texts()
    assert flying.vehicle.mode.number == 6


def photos(pilot):
    return [h for h in pilot.heard if h.message.get_type() == "CAMERA_FEEDBACK"]


def test_a_series_of_photographs_ends_by_itself(flying):
    """2000 with an interval and a count: the first at once, the next after more than 2 s each."""
    start(flying, [waypoint(0, 10), do(2000, 0, 2.0, 3), waypoint(0, 200)])
    until(flying, "Reached command #3")
    taken = [h.time_s for h in photos(flying)]
    assert len(taken) == 3
    assert taken[0] - times(flying, "Reached command #1")[0] < 0.1
    assert [b - a for a, b in pairwise(taken)] == pytest.approx([2.0, 2.0], abs=0.06)


def test_a_series_without_end_is_ended(flying):
    """2001 stops what 2000 without a count began."""
    start(flying, [waypoint(0, 10), do(2000, 0, 1.0, 0), waypoint(0, 60), do(2001),
                   waypoint(0, 90)])  # fmt: skip
    until(flying, "Reached command #3")
    taken = len(photos(flying))
    assert taken >= 4
    until(flying, "Reached command #5")
    assert len(photos(flying)) <= taken + 1


def test_distance_counts_from_the_last_photograph_and_waits_for_the_last_metres(flying):
    """206 at once, off within 114 of the next waypoint: photos at 0, 20, 40 and 60 m of 80."""
    start(flying, [waypoint(0, 20), do(206, 20, 0, 1), do(114, 10), do(206), waypoint(0, 100),
                   waypoint(0, 140)])  # fmt: skip
    until(flying, "Reached command #6")
    taken = [h.message.lat for h in photos(flying)]
    assert len(taken) == 4
    apart_m = [(b - a) / 1e7 * 111_194 for a, b in pairwise(taken)]
    assert apart_m == pytest.approx([20.0] * 3, abs=0.3)


@pytest.mark.parametrize(("behaviour", "kept"), [(0, True), (2, False)])
def test_a_heading_outlasts_its_waypoint_only_where_the_nose_is_left_alone(flying, behaviour, kept):
    """WP_YAW_BEHAVIOR 0 keeps what 115 has set; else the nose follows the route from there."""
    flying.set_parameter("WP_YAW_BEHAVIOR", behaviour)
    start(flying, [do(115, 90), waypoint(0, 60), waypoint(0, 120)])
    until(flying, "Reached command #2")
    assert flying.vehicle.body.yaw_deg == pytest.approx(90, abs=2)
    until(flying, "Reached command #3")
    assert (abs(flying.vehicle.body.yaw_deg - 90) < 2) == kept
