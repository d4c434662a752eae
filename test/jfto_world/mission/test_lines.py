"""Which waypoints are photographed along a line, and when they are passed."""

from __future__ import annotations

import dataclasses
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from jfto_msgs_py.records.plan import Line, Waypoint
from jfto_world.mission.encoding import Encoding
from jfto_world.mission.lines import PLACE_M, beside_m, trigger_lines
from jfto_world.mission.steps import Kind, route_steps
from jfto_world.motion import ConstantSpeed, MotionLimits
from jfto_world.motion.arducopter import ArduCopter
from jfto_world.motion.lines import along

LIMITS = MotionLimits(5.0, 3.0, 3.0)


def row(count, step_m=(20.0, 0.0, 2.0), start_m=(0.0, 0.0, 30.0), yaw_deg=40.0):
    """Waypoints one step apart, all looking the same way."""
    return [
        Waypoint(k, tuple(np.array(start_m) + k * np.array(step_m)), yaw_deg, -60.0)
        for k in range(count)
    ]


def lines(waypoints, trigger="distance", speed_mps=5.0):
    """Lines of a route at constant speed."""
    points = np.array([(0.0, 0.0, 0.0), *(w.position_m for w in waypoints)])
    limits = MotionLimits(speed_mps, 3.0, 3.0)
    return trigger_lines(
        waypoints,
        trigger,
        speed_mps,
        lambda found: along(ConstantSpeed(), found).arrivals(points, limits)[1:],
    )


def test_a_straight_row_is_one_line():
    """At one slope, equally spaced, looking the same way; photos one by one need none."""
    assert lines(row(8)) == (Line(0, 7),)
    assert lines(row(8), "each") == ()


def test_a_row_ends_where_lateness_would_add_up():
    """50 looks a second: at 5 m/s a photo is up to 0.1 m late, at 15 m/s 0.3 m, and so on."""
    assert lines(row(40))[:2] == (Line(0, 16), Line(17, 33))
    assert lines(row(40), speed_mps=15.0)[0] == Line(0, 6)


@pytest.mark.parametrize(
    "change",
    [
        {"position_m": (80.0, 1.5, 38.0)},
        {"position_m": (81.5, 0.0, 38.15)},
        {"position_m": (80.0, 0.0, 40.0)},
        {"yaw_deg": 41.0},
        {"pitch_deg": -61.0},
        {"photo": False},
    ],
)
def test_what_is_beside_a_line_ends_it(change):
    """Aside, unevenly spaced, higher, turned, tilted, or no photograph at all."""
    waypoints = row(9)
    waypoints[4] = dataclasses.replace(waypoints[4], **change)
    assert all(not line.first <= 4 <= line.last for line in lines(waypoints))


def test_few_waypoints_are_not_worth_a_line():
    """Three take six items either way."""
    assert lines(row(3)) == ()


def test_headings_on_both_sides_of_north_are_one():
    """359.9° and 0.1° look the same way."""
    waypoints = row(6, yaw_deg=359.9)
    waypoints[3] = dataclasses.replace(waypoints[3], yaw_deg=0.1)
    assert lines(waypoints) == (Line(0, 5),)


@settings(deadline=None, max_examples=100, derandomize=True)
@given(
    st.lists(st.tuples(st.integers(0, 3), st.integers(0, 2), st.integers(0, 1)), min_size=1),
    st.sampled_from(["distance", "time"]),
)
def test_every_line_is_one(steps, trigger):
    """Whatever the route: apart, in order, near enough; steps name every other waypoint once."""
    moves = np.cumsum([(10.0 * a, 10.0 * b, 5.0 * c) for a, b, c in steps], axis=0)
    waypoints = [Waypoint(k, tuple(place), 0.0, -60.0) for k, place in enumerate(moves)]
    found = lines(waypoints, trigger)
    assert all(before.last < after.first for before, after in pairwise(found))
    for line in found:
        assert 0 <= line.first < line.last < len(waypoints)
        assert beside_m(waypoints, line) <= PLACE_M
    arrival_s = 10.0 * np.arange(1, len(waypoints) + 1)
    written = route_steps(waypoints, arrival_s, found, Encoding(), trigger).steps
    inside = {k for line in found for k in range(line.first + 1, line.last)}
    flown = [step.waypoint for step in written if step.kind is Kind.GO]
    assert flown == [k for k in range(len(waypoints)) if k not in inside]


def test_the_vehicle_flies_a_line_in_one_go():
    """Faster than from point to point; inside it waypoints are passed in order, where they are."""
    route = np.array([(0.0, 0.0, 0.0), *(w.position_m for w in row(10, start_m=(50.0, 0.0, 30.0)))])
    model = ArduCopter(takeoff_m=20.0)
    one_by_one = model.arrivals(route, LIMITS)
    flight = along(model, (Line(0, 9),))
    reached = flight.arrivals(route, LIMITS)
    assert (np.diff(reached) > 0).all()
    assert reached[-1] < one_by_one[-1] - 4.0
    places = flight.positions(route, LIMITS, reached[2:10])
    assert np.linalg.norm(places - route[2:10], axis=1).max() < 0.5
    assert along(model, ()) is model


def test_by_time_a_line_must_be_flown_at_constant_speed():
    """From a corner the vehicle is slow at first: its photos would not be where they should."""
    model = ArduCopter(takeoff_m=20.0)

    def found(start_m):
        waypoints = row(8, step_m=(20.0, 0.0, 0.0))
        points = np.array([start_m, *(w.position_m for w in waypoints)])
        flown = lambda some: along(model, some).arrivals(points, LIMITS)[1:]  # noqa: E731
        return trigger_lines(waypoints, "time", LIMITS.speed_mps, flown)

    assert found((-100.0, 0.0, 10.0)) == (Line(0, 7),)
    assert found((0.0, 100.0, 10.0)) == ()
