"""The way home in missions."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from jfto_mavlink.errors import MissionError
from jfto_mavlink.guided.stream import homeward_item
from jfto_mavlink.mission.build import build_missions
from jfto_mavlink.mission.limits import MissionLimits
from jfto_mavlink.mission.settings import MissionSettings
from jfto_mavlink.mission.way_home import return_heights_m
from jfto_planner.home import HomeRules, with_ways_home
from jfto_world.terrain.frame import LocalFrame

WP, LOITER, LAND, RTL = 16, 19, 21, 20
SPEED, DELAY = 178, 93


def flat(east, north):
    """Ground 30 m below the frame's origin."""
    return np.full_like(np.asarray(east), -30.0) + 0.0 * north


@pytest.fixture(name="homed")
def _homed(plan):
    """The plan with ways home over low ground."""
    return with_ways_home(plan, HomeRules(flat, 15.0))


def test_the_way_home_is_flown_as_waypoints_and_lands(homed):
    """A hold of the planned whole seconds, the planned points, LAND on the pad; no RTL."""
    frame = LocalFrame(homed.origin)
    for uav, home, built in zip(
        homed.uavs, homed.homes, build_missions(homed, MissionSettings()), strict=True
    ):
        hold, *legs, land = built.mission.items[-len(home.points_m) - 1 :]
        assert (hold.command, hold.params[0]) == (LOITER, home.hold_s)
        assert [item.command for item in legs] == [WP] * (len(home.points_m) - 1)
        for item, point in zip(legs, home.points_m[1:], strict=True):
            back = frame.to_enu(item.lat_deg, item.lon_deg, built.home_deg_m[2] + item.z)
            assert np.linalg.norm(back - np.array(point)) < 0.02
            assert item.params[0] == 0.0
        assert land.command == LAND
        down = frame.to_enu(land.lat_deg, land.lon_deg, built.home_deg_m[2])
        assert np.linalg.norm(down - np.array(uav.start_m)) < 0.02
        assert dict(built.mission.parameters)["LAND_SPEED"] == 50.0
        assert built.item_map.waypoint(len(built.mission.items) - 2) is None


def test_without_the_plans_way_home_it_is_rtl(plan, homed):
    """Older plans, and missions that wait for nobody, end as before."""
    for built in (
        build_missions(plan, MissionSettings())[0],
        build_missions(homed, MissionSettings(relay_until_end=False))[0],
    ):
        assert built.mission.items[-1].command == RTL


def test_a_way_home_too_near_the_ground_is_refused(homed):
    """The legs of the way home are held against the terrain like all others."""

    def ridge(east, north):
        wall = np.hypot(east, north) > 0.0
        return np.where(wall, 400.0, -30.0)

    with pytest.raises(MissionError, match="passes"):
        build_missions(homed, MissionSettings(), ground=ridge)


def test_emergencies_return_at_heights_of_their_own(plan):
    """RTL_ALT clears the ground from anywhere on the route, and no two are within d_min."""
    limits = MissionLimits()
    heights = return_heights_m(plan, flat, limits)
    above_sea = sorted(
        uav.start_m[2] + height for uav, height in zip(plan.uavs, heights, strict=True)
    )
    assert np.diff(above_sea).min(initial=np.inf) >= plan.d_min_m
    low = replace(plan, waypoints=plan.waypoints)
    high = return_heights_m(low, lambda e, n: flat(e, n) + 200.0, limits)
    assert min(high) >= 170.0 + limits.return_clearance_m - max(u.start_m[2] for u in plan.uavs)
    built = build_missions(plan, MissionSettings(), ground=flat)
    assert [dict(one.mission.parameters)["RTL_ALT"] for one in built] == [
        100.0 * height for height in heights
    ]


def test_unknown_ground_leaves_the_vehicles_own_return_height(plan):
    """Nobody can say that 15 m are enough there."""
    assert "RTL_ALT" not in dict(build_missions(plan, MissionSettings())[0].mission.parameters)


def test_after_a_curve_the_mission_waits_where_the_vehicle_is(homed):
    """AUTO takes over at the horizon: a delay, the plan's speeds, then the same way home."""
    streamed = replace(
        homed,
        time_model="bezier",
        time_parameters={"accel_z_mps2": 2.0},
        trajectories=({},) * len(homed.uavs),
    )
    for mission, home in zip(build_missions(streamed, MissionSettings()), homed.homes, strict=True):
        first = homeward_item(mission)
        delay, *speeds = mission.mission.items[first : first + 4]
        assert (delay.command, delay.params[0]) == (DELAY, home.hold_s)
        assert [item.command for item in speeds] == [SPEED] * 3
        assert mission.mission.items[-1].command == LAND
