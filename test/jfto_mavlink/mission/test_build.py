"""Missions from plans."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from jfto_mavlink.dialect import mavlink
from jfto_mavlink.errors import MissionError
from jfto_mavlink.mission.build import build_missions
from jfto_mavlink.mission.limits import MissionLimits, check_limits
from jfto_mavlink.mission.settings import MissionSettings, settings_for
from jfto_mavlink.protocol.item import Item
from jfto_msgs_py.records.plan import Line, Route
from jfto_world.terrain.frame import LocalFrame

WP, TAKEOFF, RTL = 16, 22, 20
SPEED, MOUNT, YAW, SHUTTER, DELAY, LOITER = 178, 205, 115, 203, 93, 19
LOOK, EVERY, WITHIN, SERIES = 201, 206, 114, 2000
BY_ANGLES = MissionSettings(mount="mount_control")


def timed_plan(plan, **parameters):
    """The plan as one whose times are a mission's."""
    return dataclasses.replace(plan, time_model="arducopter", time_parameters=parameters)


def commands(mission) -> list[int]:
    return [item.command for item in mission.mission.items]


def test_items_stand_in_the_order_that_was_measured_to_work(plan):
    """Shutter, mount, heading before the next waypoint; heading last; RTL at the end."""
    first = build_missions(plan, BY_ANGLES)[0]
    photo = [MOUNT, YAW, WP, SHUTTER]
    assert commands(first) == [WP, TAKEOFF, SPEED, SPEED, SPEED, *photo * 3, LOITER, RTL]
    assert first.item_map.items == (7, 11, 15)
    takeoff = first.mission.items[1]
    assert (takeoff.frame, takeoff.z) == (3, 10.0)


def test_places_and_heights_are_those_of_the_plan(plan):
    """Heights count from the pad, not from the frame's origin."""
    frame = LocalFrame(plan.origin)
    for uav, route, built in zip(
        plan.uavs, plan.routes, build_missions(plan, MissionSettings()), strict=True
    ):
        by_id = {w.id: np.array(w.position_m) for w in plan.waypoints}
        for waypoint_id, seq in zip(route.waypoint_ids, built.item_map.items, strict=True):
            item = built.mission.items[seq]
            home_alt = frame.to_geodetic(np.array(uav.start_m))[2]
            back = frame.to_enu(item.lat_deg, item.lon_deg, home_alt + item.z)
            assert np.linalg.norm(back - by_id[waypoint_id]) < 0.02
            assert item.frame == mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT


def test_camera_angles_reach_the_items(plan):
    """Pitch in the mount item, heading in CONDITION_YAW, 0 to 360 degrees, absolute."""
    built = build_missions(plan, BY_ANGLES)[0]
    waypoints = {w.id: w for w in plan.waypoints}
    for waypoint_id, seq in zip(built.waypoint_ids, built.item_map.items, strict=True):
        mount, yaw = built.mission.items[seq - 2 : seq]
        assert mount.params[0] == pytest.approx(waypoints[waypoint_id].pitch_deg)
        assert yaw.params[0] == pytest.approx(waypoints[waypoint_id].yaw_deg % 360, abs=1e-4)
        assert yaw.params[3] == 0.0


def test_one_item_looks_along_the_line_of_sight_of_a_photo(plan):
    """A far place on it, as seen from the waypoint, instead of a mount's and a heading's item."""
    first = build_missions(plan, MissionSettings())[0]
    photo = [LOOK, WP, SHUTTER]
    assert commands(first) == [WP, TAKEOFF, SPEED, SPEED, SPEED, *photo * 3, LOITER, RTL]
    frame, waypoints = LocalFrame(plan.origin), {w.id: w for w in plan.waypoints}
    home_alt = first.home_deg_m[2]
    for waypoint_id, seq in zip(first.waypoint_ids, first.item_map.items, strict=True):
        look, waypoint = first.mission.items[seq - 1], waypoints[waypoint_id]
        far = frame.to_enu(look.lat_deg, look.lon_deg, home_alt + look.z)
        east, north, up = far - np.array(waypoint.position_m)
        assert np.degrees(np.arctan2(east, north)) % 360 == pytest.approx(
            waypoint.yaw_deg % 360, abs=0.01
        )
        assert np.degrees(np.arctan2(up, np.hypot(east, north))) == pytest.approx(
            waypoint.pitch_deg, abs=0.015
        )


def alike(plan, **changes):
    """The plan with all waypoints looking the same way."""
    waypoints = tuple(dataclasses.replace(w, yaw_deg=40.0, pitch_deg=-60.0) for w in plan.waypoints)
    return dataclasses.replace(plan, waypoints=waypoints, **changes)


def test_what_does_not_change_is_set_once(plan):
    """One mount, one heading; the autopilot is told not to turn the nose along the route."""
    built = build_missions(alike(plan), MissionSettings(set_speeds=False))[0]
    photo = [WP, SHUTTER]
    assert commands(built) == [WP, TAKEOFF, MOUNT, YAW, *photo * 3, LOITER, RTL]
    assert dict(built.mission.parameters)["WP_YAW_BEHAVIOR"] == 0.0
    turning = build_missions(plan, MissionSettings())[0]
    assert "WP_YAW_BEHAVIOR" not in dict(turning.mission.parameters)


def test_a_turn_that_may_not_have_ended_is_ordered_again(plan):
    """The next waypoint stops a turn; a leg of less than 4 s may be too short for it."""
    routes = (dataclasses.replace(plan.routes[0], arrival_s=(3.0, 30.0, 47.5)), plan.routes[1])
    built = build_missions(alike(plan, routes=routes), MissionSettings(set_speeds=False))[0]
    photo = [WP, SHUTTER]
    assert commands(built) == [WP, TAKEOFF, MOUNT, YAW, *photo, YAW, *photo * 2, LOITER, RTL]


def test_steep_cameras_are_turned_by_angles(plan):
    """Straight down, a far place has no bearing."""
    down = tuple(dataclasses.replace(w, pitch_deg=-89.0) for w in plan.waypoints)
    built = build_missions(dataclasses.replace(plan, waypoints=down), MissionSettings())[0]
    assert LOOK not in commands(built)
    assert commands(built).count(YAW) == 3


def test_a_place_to_pass_takes_one_item(plan):
    """It is no photograph: nothing is aimed, no shutter."""
    passing = dataclasses.replace(plan.waypoints[2], photo=False)
    assert passing.id == 3
    waypoints = (*plan.waypoints[:2], passing, *plan.waypoints[3:])
    built = build_missions(dataclasses.replace(plan, waypoints=waypoints), MissionSettings())[0]
    photo = [LOOK, WP, SHUTTER]
    assert commands(built)[5:] == [*photo, WP, *photo, LOITER, RTL]


@pytest.mark.parametrize(
    ("trigger", "row"), [("distance", [EVERY, WITHIN, EVERY]), ("time", [SERIES])]
)
def test_a_line_is_flown_in_one_go(plan, trigger, row):
    """Its camera is triggered along the way, its last photo taken where it is reached."""
    routes = (dataclasses.replace(plan.routes[0], lines=(Line(0, 2),)), plan.routes[1])
    straight = tuple(
        dataclasses.replace(w, position_m=(30.0 * w.id, 0.0, 30.0)) for w in plan.waypoints
    )
    lined = dataclasses.replace(alike(plan, routes=routes), trigger=trigger)
    lined = dataclasses.replace(
        lined,
        waypoints=tuple(
            dataclasses.replace(w, position_m=s.position_m)
            for w, s in zip(lined.waypoints, straight, strict=True)
        ),
    )
    built = build_missions(lined, MissionSettings(set_speeds=False))[0]
    assert commands(built) == [WP, TAKEOFF, MOUNT, YAW, WP, *row, WP, SHUTTER, LOITER, RTL]
    first = built.mission.items[5]
    if trigger == "distance":
        assert first.params[:3] == (60.0, 0.0, 1.0)
        assert built.mission.items[6].params[0] == 30.0
    else:
        assert first.params[:3] == (0.0, pytest.approx(15.0), 2.0)
    end = 5 + len(row)
    assert built.item_map.items == (4, end, end)
    assert built.item_map.waypoint(end) == 2
    assert built.item_map.next_waypoint(5) == 1
    with pytest.raises(MissionError, match=r"gate behind waypoint 2 .* to waypoint 3"):
        build_missions(lined, MissionSettings(gates=(1,), start_unix_s=1.8e9))


def test_holding_sharpens_and_every_part_can_be_left_out(plan):
    """Bare waypoints with a hold remain when nothing else is wanted."""
    settings = MissionSettings(
        style="hold",
        hold_s=2.0,
        shutter="none",
        mount="none",
        turn_to_target=False,
        set_speeds=False,
        relay_until_end=False,
    )
    built = build_missions(plan, settings)[0]
    assert commands(built) == [WP, TAKEOFF, WP, WP, WP, RTL]
    assert all(built.mission.items[seq].params[0] == 2.0 for seq in built.item_map.items)


def test_a_uav_stays_as_a_relay_until_the_horizon(plan):
    """It waits at its last waypoint for what the plan leaves after its arrival."""
    built = build_missions(plan, MissionSettings())
    for route, mission in zip(plan.routes, built, strict=True):
        loiter = mission.mission.items[-2]
        assert loiter.command == LOITER
        assert loiter.params[0] == np.ceil(plan.slots.horizon_s - route.arrival_s[-1])


def test_a_low_last_waypoint_climbs_before_it_returns(plan):
    """RTL flies straight home at the height it has: a ridge may stand between."""
    built = build_missions(plan, MissionSettings(return_height_m=80.0))[0]
    climb, rtl = built.mission.items[-2:]
    assert (climb.command, climb.z) == (WP, 80.0)
    assert rtl.command == RTL
    assert built.item_map.waypoint(len(built.mission.items) - 2) is None


def test_gates_name_the_second_of_the_minute_only(plan):
    """With hour and minute a late vehicle would wait a day."""
    start = 1_795_312_833.0
    built = build_missions(plan, MissionSettings(gates=(1,), start_unix_s=start))[0]
    gate = built.mission.items[built.item_map.items[1] + 2]
    assert gate.command == DELAY
    leave = np.ceil(start + plan.routes[0].arrival_s[1] + 5.0) % 60
    assert gate.params == (-1.0, -1.0, -1.0, leave)


@pytest.mark.parametrize("behind", [0, 1])
def test_a_reached_do_item_stands_for_the_waypoint_before_it(plan, behind):
    """MISSION_ITEM_REACHED may carry the number of a DO item behind the waypoint."""
    built = build_missions(plan, MissionSettings())[0]
    for index, seq in enumerate(built.item_map.items):
        assert built.item_map.waypoint(seq + behind) == index
    assert built.item_map.waypoint(1) is None
    assert built.item_map.waypoint(10_000) is None
    assert built.item_map.next_waypoint(built.item_map.items[0] + 1) == 1


def test_what_the_autopilot_would_store_unchecked_is_refused(plan):
    """Below home, too far, too many items: named with the item's number."""
    low = dataclasses.replace(plan.waypoints[0], position_m=(50.0, 0.0, -60.0))
    with pytest.raises(MissionError, match=r"item 6: height -\d+"):
        build_missions(
            dataclasses.replace(plan, waypoints=(low, *plan.waypoints[1:])), MissionSettings()
        )
    with pytest.raises(MissionError, match="from home"):
        build_missions(plan, MissionSettings(limits=MissionLimits(distance_max_m=20.0)))
    with pytest.raises(MissionError, match="at most 650"):
        check_limits("x", [Item(16)] + [Item(22)] * 650, MissionLimits())
    with pytest.raises(MissionError, match="at most 10"):
        build_missions(plan, MissionSettings(limits=MissionLimits(items_max=10)))


@pytest.mark.parametrize(
    "wrong",
    [
        {"style": "fast"},
        {"shutter": "loud"},
        {"style": "hold", "hold_s": 0.4},
        {"takeoff_height_m": 0.0},
        {"gates": (0,)},
        {"gate_slack_s": 45.0},
    ],
)
def test_impossible_settings_are_refused(wrong):
    """Before any mission is built."""
    with pytest.raises(MissionError):
        MissionSettings(**wrong)


def test_terrain_heights_are_refused_with_the_reason():
    """Without loaded terrain the vehicle descends into the ground."""
    with pytest.raises(MissionError, match="TERRAIN_DATA"):
        MissionSettings(terrain_frame=True)


def test_a_route_with_an_unknown_waypoint_is_refused(plan):
    """A plan that contradicts itself is not flown."""
    with pytest.raises(MissionError, match="not in the plan"):
        build_missions(dataclasses.replace(plan, waypoints=plan.waypoints[1:]), MissionSettings())


def test_a_uav_without_waypoints_hovers_as_a_relay(plan):
    """Over its pad until the horizon, then it lands; the mission is valid for AUTO."""
    idle = dataclasses.replace(plan, routes=(plan.routes[0], Route((), (), 0.0)))
    built = build_missions(idle, MissionSettings(set_speeds=False))[1]
    assert commands(built) == [WP, TAKEOFF, LOITER, RTL]
    loiter = built.mission.items[2]
    assert loiter.params[0] == plan.slots.horizon_s
    assert loiter.z == 10.0


def test_legs_too_near_the_ground_are_refused_and_the_way_home_clears_it(plan):
    """With the terrain known, a ridge under a leg is found, one on the way home is climbed over."""
    flat = lambda x, y: np.zeros_like(x) - 5.0 + 0.0 * y  # noqa: E731
    clear = build_missions(plan, MissionSettings(), ground=flat)[0]
    assert clear.mission.items[-2].command == LOITER

    def ridge(x, y):
        return np.where(np.abs(x - 70.0) < 15.0, 33.0, -5.0) + 0.0 * y

    with pytest.raises(MissionError, match=r"uav1: the leg .* passes .* above the ground"):
        build_missions(plan, MissionSettings(), ground=ridge)

    def hill_beside_the_route(x, y):
        home_line = np.abs(y - 60.0 * x / 200.0) < 3.0
        return np.where(home_line & (x > 170.0) & (x < 182.0), 100.0, -50.0)

    built = build_missions(plan, MissionSettings(), ground=hill_beside_the_route)[0]
    climb = built.mission.items[-2]
    assert climb.command == WP
    assert climb.z == pytest.approx(120.0, abs=0.1)


def test_waypoints_below_the_pad_are_allowed_where_the_terrain_is_known(plan):
    """A pad on a mountainside stands above some of its waypoints."""
    low = dataclasses.replace(plan.waypoints[0], position_m=(50.0, 0.0, -60.0))
    below = dataclasses.replace(plan, waypoints=(low, *plan.waypoints[1:]))
    built = build_missions(below, MissionSettings(), ground=lambda x, y: 0.0 * x * y - 100.0)[0]
    assert built.mission.items[built.item_map.items[0]].z < -55.0


def test_how_close_waypoints_are_passed_is_a_parameter_that_rides_along(plan):
    """WPNAV_RADIUS, in centimetres, and the fence's heights where asked for."""
    built = build_missions(plan, MissionSettings(pass_within_m=1.0), fence_heights_m=(-10.0, 90.0))
    assert dict(built[0].mission.parameters) == {
        "WPNAV_RADIUS": 60.0,
        "FENCE_ALT_MIN": -10.0,
        "FENCE_ALT_MAX": 90.0,
    }


def test_all_that_the_times_of_a_mission_rely_on_rides_along(plan):
    """Speeds of each UAV and the planner's parameters as planned, in the autopilot's units."""
    timed = timed_plan(plan, takeoff_m=10.0, radius_m=1.2, jerk_mps3=2.0, angle_max_deg=25.0)
    sent = dict(build_missions(timed, MissionSettings())[0].mission.parameters)
    assert sent["WPNAV_SPEED"] == 100 * timed.uavs[0].speed_mps
    assert sent["WPNAV_SPEED_UP"] == 100 * timed.uavs[0].climb_mps
    assert (sent["WPNAV_RADIUS"], sent["WPNAV_JERK"], sent["ANGLE_MAX"]) == (120.0, 2.0, 2500)
    assert (sent["WPNAV_ACCEL"], sent["WPNAV_ACCEL_Z"], sent["ATC_INPUT_TC"]) == (
        250.0,
        100.0,
        0.15,
    )


def test_waypoints_cannot_be_passed_nearer_than_planned(plan):
    """A plan timed with wide corners does not hold for narrow ones: MissionError says so."""
    timed = dataclasses.replace(
        plan, time_model="arducopter", time_parameters={"radius_m": 1.2, "takeoff_m": 10.0}
    )
    with pytest.raises(MissionError, match=r"trajectory.wpnav_radius_m 0.6"):
        build_missions(timed, MissionSettings(pass_within_m=1.0))


@pytest.mark.parametrize(
    ("parameters", "choices", "cure"),
    [
        ({"takeoff_m": 30.0}, {}, r"trajectory\.takeoff_m 10"),
        ({"takeoff_m": 10.0}, {"style": "hold"}, r"trajectory\.hold_s 1"),
        ({"takeoff_m": 10.0, "hold_s": 2.0}, {}, r"trajectory\.hold_s 0"),
        ({"takeoff_m": 10.0, "hold_s": 2.0}, {"style": "hold"}, r"a hold of 2 s"),
        ({}, {}, r"lift-off to 0 m"),
    ],
)
def test_a_mission_that_is_not_flown_as_timed_is_refused(plan, parameters, choices, cure):
    """Another lift-off or other holds would break every arrival; the cure is named."""
    with pytest.raises(MissionError, match=cure):
        build_missions(timed_plan(plan, **parameters), MissionSettings(**choices))


def test_what_is_not_chosen_is_as_planned(plan):
    """Height of lift-off and holds come from the plan where it has them, else are the defaults."""
    timed = timed_plan(plan, takeoff_m=30.0, hold_s=2.0, radius_m=1.2)
    settings = settings_for(timed, style=None, takeoff_height_m=None, pass_within_m=2.0)
    assert (settings.style, settings.hold_s, settings.takeoff_height_m) == ("hold", 2.0, 30.0)
    built = build_missions(timed, settings)[0]
    assert built.mission.items[1].z == 30.0
    assert {built.mission.items[seq].params[0] for seq in built.item_map.items} == {2.0}
    assert settings_for(plan, style=None) == MissionSettings()
    assert settings_for(timed, takeoff_height_m=12.0).takeoff_height_m == 12.0
