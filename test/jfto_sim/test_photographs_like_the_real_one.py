"""Photographs of a mission: where they are taken and where the nose points, on either vehicle.

One route with a look to somewhere else at every waypoint, then a line triggered by distance or
time whose heading is set once, then single photographs that keep it.
"""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest

from jfto_mavlink.mission.build import build_missions
from jfto_mavlink.mission.settings import settings_for
from jfto_msgs_py.records.plan import Line, Origin, Plan, Uav, Waypoint
from jfto_msgs_py.records.radio import Radio
from jfto_planner.routing.build_plan import PlanTerms, build_plan
from jfto_sim import VehicleConfig
from jfto_sim.geodesy import wrap_180
from jfto_sim.mission.items import Item
from jfto_world.terrain.frame import LocalFrame

HOME = VehicleConfig()
# A waypoint is passed within this, and so its photograph is taken.
WITHIN_M, HEADING_DEG = 3.0, 3.0


def waypoints() -> tuple[Waypoint, ...]:
    """Five that look elsewhere each, a line of ten, a corner, three along another course."""
    places = [(40.0 * k, 30.0 * (k % 2), 30.0) for k in range(1, 6)]
    looks = [(300.0, -70.0), (60.0, -45.0), (180.0, -80.0), (20.0, -60.0), (250.0, -50.0)]
    places += [(200.0, 60.0 + 20.0 * k, 30.0 + k) for k in range(10)]
    places += [(160.0 - 40.0 * k, 260.0, 40.0) for k in range(3)]
    looks += [(140.0, -60.0)] * 13
    return tuple(
        Waypoint(k, place, *look) for k, (place, look) in enumerate(zip(places, looks, strict=True))
    )


def plan(trigger: str) -> Plan:
    """One UAV on this route, timed as a mission of the autopilot."""
    uav = Uav("uav1", 30.0, 200.0, 900.0, 6.0, 3.0, 3.0, (0.0, 0.0, 0.0))
    origin = Origin(HOME.home_lat_deg, HOME.home_lon_deg, HOME.home_alt_m)
    terms = PlanTerms(
        "0" * 64, 1, origin, Radio(), 0, 1, 5.0, 1e6, 20, None, waypoints(), (uav,), trigger=trigger
    )  # fmt: skip
    parameters = {"takeoff_m": 20.0, "radius_m": 1.2}
    return build_plan([range(len(terms.waypoints))], terms, "arducopter", parameters)


@pytest.fixture
def photographed(pilots):
    """Flies a plan's mission; the places (ENU) and headings of its photographs, in order."""

    def fly(planned: Plan) -> list[tuple[np.ndarray, float]]:
        (built,) = build_missions(planned, settings_for(planned))
        pilot = pilots(HOME, CAM1_TYPE=1)
        pilot.ready()
        for name, value in built.mission.parameters:
            pilot.set_parameter(name, value)
        items = [
            Item(each.command, each.frame, each.params, each.x, each.y, each.z)
            for each in built.mission.items
        ]
        assert pilot.upload(items) == 0
        pilot.command(176, 1, 4)
        assert pilot.command(400, 1) == 0
        assert pilot.command(300) == 0
        last = built.item_map.items[-1]
        pilot.wait(
            lambda m: m.get_type() == "STATUSTEXT" and m.text == f"Reached command #{last}", 600.0
        )
        pilot.run(2.0)
        frame = LocalFrame(planned.origin)
        return [
            (np.array(frame.to_enu(m.lat / 1e7, m.lng / 1e7, m.alt_msl)), m.yaw)
            for m in (heard.message for heard in pilot.heard)
            if m.get_type() == "CAMERA_FEEDBACK"
        ]

    return fly


def compare(planned: Plan, photos: list[tuple[np.ndarray, float]]) -> tuple[np.ndarray, np.ndarray]:
    """How far each photograph is from its waypoint, and its heading from the planned one."""
    assert len(photos) == len(planned.waypoints)
    apart = [
        math.dist(place, waypoint.position_m)
        for (place, _), waypoint in zip(photos, planned.waypoints, strict=True)
    ]
    turned = [
        abs(wrap_180(yaw - waypoint.yaw_deg))
        for (_, yaw), waypoint in zip(photos, planned.waypoints, strict=True)
    ]
    print("apart", np.round(apart, 2).tolist(), "turned", np.round(turned, 1).tolist())
    return np.array(apart), np.array(turned)


@pytest.mark.slow
@pytest.mark.parametrize(("trigger", "lines"), [("each", ()), ("distance", ((5, 14),))])
def test_photographs_are_taken_as_planned(photographed, trigger, lines):
    """One each, near its waypoint and looking where it should, with what was set once too."""
    planned = plan(trigger)
    assert planned.routes[0].lines == tuple(Line(*each) for each in lines)
    apart, turned = compare(planned, photographed(planned))
    assert apart.max() < WITHIN_M
    assert turned.max() < HEADING_DEG


@pytest.mark.slow
def test_photographs_by_time_are_taken_where_speed_is_constant(photographed):
    """The way to the line is straight, and its last photograph is taken where it ends."""
    planned = plan("time")
    assert planned.routes[0].lines == (Line(5, 14),)
    apart, turned = compare(planned, photographed(planned))
    assert apart.max() < WITHIN_M
    assert turned.max() < HEADING_DEG


@pytest.mark.slow
def test_angles_and_looks_point_the_nose_alike(photographed):
    """What every photograph was given by two orders, one order gives too."""
    planned = dataclasses.replace(plan("each"), waypoints=waypoints()[:5])
    route = dataclasses.replace(
        planned.routes[0], waypoint_ids=tuple(range(5)), arrival_s=planned.routes[0].arrival_s[:5]
    )
    planned = dataclasses.replace(planned, routes=(route,))
    apart, turned = compare(planned, photographed(planned))
    assert apart.max() < WITHIN_M
    assert turned.max() < HEADING_DEG
