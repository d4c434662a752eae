"""Waypoints inside a line, of which the vehicle itself says nothing."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from jfto_mavlink.dialect import mavlink
from jfto_mavlink.flight.follow import Follower
from jfto_mavlink.mission.build import build_missions
from jfto_mavlink.mission.settings import MissionSettings
from jfto_msgs_py.records.plan import Line
from jfto_world.terrain.frame import LocalFrame


@pytest.fixture
def lined(plan):
    """uav1 photographs its three waypoints, 60 m apart, on one line by distance."""
    waypoints = tuple(
        dataclasses.replace(w, position_m=(30.0 * w.id, 0.0, 30.0), yaw_deg=40.0, pitch_deg=-60.0)
        for w in plan.waypoints
    )
    routes = (dataclasses.replace(plan.routes[0], lines=(Line(0, 2),)), plan.routes[1])
    return dataclasses.replace(plan, waypoints=waypoints, routes=routes, trigger="distance")


def follow(plan, path_m):
    """A follower of uav1 that was told that its first item was reached, then of places (K, 3)."""
    mission = build_missions(plan, MissionSettings())[0]
    follower = Follower(mission, 0.0)
    begin, _, end = mission.item_map.items
    follower.take(mavlink.MAVLink_mission_item_reached_message(begin), 10.0)
    frame = LocalFrame(plan.origin)
    for number, place in enumerate(path_m):
        lat, lon, alt = (float(value) for value in frame.to_geodetic(place))
        message = mavlink.MAVLink_global_position_int_message(
            0, round(lat * 1e7), round(lon * 1e7), 0,
            round(1e3 * (alt - mission.home_deg_m[2])), 0, 0, 0, 0,
        )  # fmt: skip
        follower.take(message, 11.0 + number)
    return follower, end


def straight(east_m, north_m=0.0):
    """Places along the line, so far beside it."""
    return [np.array([east, north_m, 30.0]) for east in east_m]


def test_they_are_passed_where_the_vehicle_was(lined):
    """Its own positions tell when and how near, long before the line's end is reported."""
    follower, _ = follow(lined, straight([30.0, 50.0, 70.0, 85.0, 95.0]))
    assert follower.done == 2
    inside = follower.passages[1]
    assert inside.reached_s == 15.0
    assert inside.closest_m < 0.1
    assert inside.visited


def test_a_line_flown_beside_its_waypoints_passes_none(lined):
    """The end of the line is reached; what lies inside was not."""
    follower, end = follow(lined, straight([30.0, 60.0, 90.0, 120.0, 140.0], 20.0))
    follower.take(mavlink.MAVLink_mission_item_reached_message(end), 30.0)
    assert follower.done == 3
    assert follower.passages[1].reached_s is None
    assert not follower.passages[1].visited
    assert follower.passages[2].reached_s == 30.0


def test_without_positions_nothing_is_made_up(lined):
    """An item that was reached says nothing of the photographs on the way."""
    follower, end = follow(lined, [])
    follower.take(mavlink.MAVLink_mission_item_reached_message(end), 30.0)
    assert [each.reached_s for each in follower.passages] == [10.0, None, 30.0]
