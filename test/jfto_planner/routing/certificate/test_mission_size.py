"""Whether routes fit into the missions of an autopilot."""

from __future__ import annotations

import dataclasses
import itertools

import numpy as np
import pytest

from jfto_mavlink.errors import MissionError
from jfto_mavlink.mission.build import build_missions
from jfto_mavlink.mission.settings import MissionSettings
from jfto_msgs_py.errors import InfeasibleError
from jfto_msgs_py.records.plan import Line, Origin, Plan, Route, Slots, Uav, Waypoint
from jfto_msgs_py.records.radio import Radio
from jfto_msgs_py.records.way_home import WayHome
from jfto_planner.routing import certify
from jfto_planner.routing.certificate.mission_size import (
    check_lines,
    check_mission_size,
    least_items,
    photo_capacity,
    require_missions_to_hold,
)
from jfto_world.mission.encoding import MOUNTS, SHUTTERS
from jfto_world.mission.steps import mission_items


def plan_of(*photos: int, varied: bool = True) -> Plan:
    """A UAV for each count of photos, on a line above its pad; all look elsewhere if `varied`."""
    ids = np.split(np.arange(sum(photos)), np.cumsum(photos)[:-1])
    waypoints = tuple(
        Waypoint(k, (10.0 * k, 0.0, 50.0), 10.0 + varied * (k % 90), -80.0 + varied * (k // 90))
        for k in range(sum(photos))
    )
    uavs = tuple(
        Uav(f"uav{n + 1}", 30.0, 200.0, 9000.0, 8.0, 4.0, 3.0, (0.0, 20.0 * n, 0.0))
        for n in range(len(photos))
    )
    routes = tuple(Route(tuple(map(int, own)), tuple(10.0 + 5.0 * own), 1.0) for own in ids)
    shape = (len(photos), 11, 3)
    return Plan(
        "0" * 64, 1, Origin(47.0, 8.0, 500.0), Radio(), 0, 1, 5.0, 1e6, Slots(10, 350.0),
        waypoints, uavs, routes, np.zeros(shape),
    )  # fmt: skip


def with_lines(plan: Plan, trigger: str) -> Plan:
    """All routes photographed on one line after the other, ten photos each."""
    routes = tuple(
        dataclasses.replace(
            route,
            lines=tuple(Line(k, k + 9) for k in range(0, len(route.waypoint_ids) - 9, 10)),
        )
        for route in plan.routes
    )
    return dataclasses.replace(plan, routes=routes, trigger=trigger)


def with_homes(plan: Plan) -> Plan:
    """Two legs home for everybody."""
    home = WayHome(((0.0, 0.0, 80.0), (0.0, 0.0, 60.0), (0.0, 0.0, 0.0)), (1.0, 2.0, 3.0), 4.0)
    return dataclasses.replace(plan, homes=(home,) * len(plan.uavs))


ENCODINGS = [
    {"mount": mount, "shutter": shutter, "turn_to_target": turn, "set_speeds": turn}
    for mount, shutter, turn in itertools.product(MOUNTS, SHUTTERS, (True, False))
]
PLANS = [
    plan_of(57, 3),
    plan_of(57, 3, varied=False),
    with_lines(plan_of(57, 3, varied=False), "distance"),
    with_lines(plan_of(57, 3, varied=False), "time"),
]


@pytest.mark.parametrize("settings", ENCODINGS)
@pytest.mark.parametrize("plan", PLANS, ids=["varied", "alike", "distance", "time"])
def test_the_count_is_that_of_missions_as_built(plan, settings):
    """Exactly, for every encoding; of a plain return, the climb that it may begin with is one."""
    chosen = MissionSettings(**settings)
    for index, built in enumerate(build_missions(plan, chosen)):
        counted = mission_items(plan, index, chosen.encoding)
        assert counted - len(built.mission.items) == 1


def test_a_route_that_no_autopilot_holds_is_a_violation():
    """UAV, items and cure are named; a UAV that can hold its own is not."""
    (found,) = check_mission_size(plan_of(261, 200))
    assert (found.kind, found.uav, found.value, found.limit) == ("items", "uav1", 791, 650)
    assert "fleet.count" in found.message
    assert "coverage.trigger" in found.message


def test_what_an_autopilot_holds_is_a_key_of_the_fleet():
    """A board that holds more takes more, and missions are built for it."""
    plan = dataclasses.replace(plan_of(261, 200), mission_items=800)
    assert not check_mission_size(plan)
    assert len(build_missions(plan, MissionSettings())[0].mission.items) == 790
    with pytest.raises(MissionError, match="at most 650"):
        build_missions(dataclasses.replace(plan, mission_items=650), MissionSettings())


def test_lines_spare_items():
    """A line of ten photographs takes six items, and its heading is set once."""
    each = mission_items(plan_of(100, varied=False), 0)
    lines = mission_items(with_lines(plan_of(100, varied=False), "distance"), 0)
    assert (each, lines) == (5 + 2 + 200 + 3, 5 + 2 + 60 + 3)


def test_waypoints_that_fit_no_division_are_refused_before_the_search():
    """Two UAVs and 480 waypoints that all look elsewhere: three are needed, and that is said."""
    waypoints = plan_of(480).waypoints
    assert least_items(waypoints) == 3 * 480
    with pytest.raises(InfeasibleError, match=r"480 photographs do not fit .* 2 UAVs") as caught:
        require_missions_to_hold(waypoints, 2, 650)
    assert "fleet.count of 3 or more" in caught.value.cures
    assert any("coverage.trigger" in cure for cure in caught.value.cures)
    require_missions_to_hold(plan_of(480, varied=False).waypoints, 2, 650)


def test_routes_may_have_what_surely_fits_else_a_little_over_an_even_share():
    """The search is kept from routes that no autopilot holds."""
    assert photo_capacity(plan_of(300).waypoints, 2, 650) == 210
    assert photo_capacity(plan_of(500, varied=False).waypoints, 2, 650) == 275


def test_a_line_that_is_none_is_a_violation():
    """Somebody who writes lines into a plan by hand is told which waypoint is beside one."""
    good = with_lines(plan_of(20, varied=False), "distance")
    assert not check_lines(good)
    aside = dataclasses.replace(good.waypoints[4], position_m=(40.0, 3.0, 50.0))
    moved = dataclasses.replace(good, waypoints=(*good.waypoints[:4], aside, *good.waypoints[5:]))
    (found,) = check_lines(moved)
    assert (found.kind, found.uav) == ("line", "uav1")
    assert "3.00 m beside it" in found.message
    turned = dataclasses.replace(good.waypoints[4], yaw_deg=40.0)
    moved = dataclasses.replace(good, waypoints=(*good.waypoints[:4], turned, *good.waypoints[5:]))
    assert "does not look the same way" in check_lines(moved)[0].message


def test_a_plan_checked_again_names_it_too():
    """The rule is of the certificate, so that `jfto check` knows it."""
    plan = dataclasses.replace(plan_of(300), time_model="constant_speed")
    assert "items" in {violation.kind for violation in certify(plan).violations}
