"""What UAVs are told to fly against the plan that it comes from."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from jfto_msgs_py.errors import InputError
from jfto_msgs_py.records.plan import Plan, Route
from jfto_msgs_py.scenario import Given, make_scenario
from jfto_planner.plan_trajectory import timed_paths, timed_trajectories
from jfto_planner.smoothing import CurveLimits, RouteRequest, smooth_route
from jfto_world.motion.progress import sample
from support.graph import SCENARIO
from support.plans import side_by_side

START_NS = 1_763_776_800_123_456_789


@pytest.fixture(scope="module")
def plan() -> Plan:
    """Three UAVs, two waypoints each."""
    layer = {name: Given(value, "test") for name, value in SCENARIO.items()}
    return side_by_side(make_scenario([layer]))


def test_straight_legs_pass_the_slots_positions(plan) -> None:
    """Between samples the motion is straight, so that few samples say it exactly."""
    for index, (uav, flown) in enumerate(timed_trajectories(plan, START_NS).items()):
        assert uav == plan.uavs[index].id
        assert flown.start_ns == START_NS
        assert len(flown.offset_ns) == 3
        found = sample(flown.offset_ns / 1e9, flown.position_m, plan.slots.times_s)
        assert np.allclose(found, plan.positions_m[index], atol=1e-4)
        assert (flown.velocity_mps[-1] == 0).all()


def test_paths_start_at_the_pad(plan) -> None:
    """Stamps are lift-off plus arrival to the nanosecond; the pad looks where the first does."""
    path = timed_paths(plan, START_NS)["uav2"]
    assert path.points_m[0].tolist() == list(plan.uavs[1].start_m)
    assert path.arrival_ns[0] == START_NS
    assert path.arrival_ns[2] == START_NS + round(plan.routes[1].arrival_s[1] * 1e9)
    assert path.yaw_deg.tolist() == [30.0, 30.0, 30.0]


def test_a_uav_without_waypoints_stays_on_its_pad(plan) -> None:
    """One sample, one point."""
    idle = replace(plan, routes=(Route((), (), 0.0), *plan.routes[1:]))
    assert timed_trajectories(idle, START_NS)["uav1"].offset_ns.tolist() == [0]
    assert len(timed_paths(idle, START_NS)["uav1"].points_m) == 1


def test_smoothed_trajectories_are_sampled(plan) -> None:
    """Where the plan has curves, those are flown: their ends, and motion within the limits."""
    limits = CurveLimits(10.0, 4.0, 3.0)
    curves = []
    for uav, route in zip(plan.uavs, plan.routes, strict=True):
        places = {waypoint.id: waypoint.position_m for waypoint in plan.waypoints}
        line = np.array([uav.start_m, *(places[number] for number in route.waypoint_ids)])
        curves.append(smooth_route(RouteRequest(line, limits)))
    smooth = replace(plan, trajectories=tuple(curve.as_record() for curve in curves))
    for curve, flown in zip(curves, timed_trajectories(smooth, START_NS).values(), strict=True):
        assert flown.offset_ns[-1] == round(curve.end_s * 1e9)
        assert np.allclose(flown.position_m[-1], curve.control_m[-1, -1], atol=1e-6)
        assert np.linalg.norm(flown.velocity_mps[:, :2], axis=1).max() <= 10.0 * 1.001


def test_an_unknown_curve_is_refused(plan) -> None:
    """A sentence instead of a guess."""
    with pytest.raises(InputError, match="must be 'bezier5'"):
        timed_trajectories(replace(plan, trajectories=({"kind": "spline"},) * 3), START_NS)
