"""Rules of smoothed routes."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from jfto_msgs_py.errors import InputError
from jfto_planner.smoothing import (
    CurveLimits,
    RouteRequest,
    SmoothingSettings,
    rest_to_rest_s,
    smooth_route,
)
from jfto_planner.smoothing.kernel.segment import least_duration
from jfto_world.compiled import kernel
from support.curves import (
    limit_ratios,
    ratios_at_samples,
    sampled,
    straight_line_s,
    worst_jump,
)


@kernel
def duration_of(start, end, lim, room):
    return least_duration(start, end, 1e3, lim, 256, room)


LIMITS = CurveLimits(speed_mps=10.0, climb_mps=4.0, descent_mps=3.0)


def random_route(seed, count=8, spread=150.0):
    rng = np.random.default_rng(seed)
    walk = np.cumsum(rng.uniform(-1, 1, (count, 2)), axis=0) * spread
    return np.column_stack([walk, rng.uniform(40, 40 + 0.2 * spread, count)])


@pytest.mark.slow
@settings(deadline=None, max_examples=25, derandomize=True)
@given(st.floats(0.5, 400.0), st.floats(2, 15), st.floats(0.5, 6), st.floats(0.5, 20))
def test_rest_to_rest_equals_the_closed_form(length, speed, accel, jerk):
    """One segment from rest to rest takes the closed form's time, within 0.1 %."""
    limits = CurveLimits(speed, 5, 5, accel, 5, jerk, 60.0)
    start, end = np.zeros((3, 3)), np.zeros((3, 3))
    end[0, 0] = length
    expected = rest_to_rest_s(length, speed, accel, jerk)
    found = duration_of(start, end, limits.row(), np.empty((6, 3)))
    assert found == pytest.approx(expected, rel=1e-3)


@pytest.mark.slow
@settings(deadline=None, max_examples=20, derandomize=True)
@given(st.integers(0, 100_000), st.floats(15, 300))
def test_limits_hold_everywhere(seed, spread):
    """At 1000 samples per segment, and by the hull everywhere, every limit is kept."""
    route = random_route(seed, 7, spread)
    trajectory = smooth_route(RouteRequest(route, LIMITS))
    for name, ratio in ratios_at_samples(trajectory, LIMITS).items():
        assert ratio <= 1.0, name
    for name, ratio in limit_ratios(trajectory, LIMITS, halvings=6).items():
        assert ratio <= 1.001, name


@pytest.mark.slow
@settings(deadline=None, max_examples=20, derandomize=True)
@given(st.integers(0, 100_000), st.floats(15, 300))
def test_joints_are_continuous_and_waypoints_are_met(seed, spread):
    """Position, velocity, acceleration agree at joints to 1e-9; each waypoint is passed on time."""
    route = random_route(seed, 7, spread)
    trajectory = smooth_route(RouteRequest(route, LIMITS))
    assert worst_jump(trajectory, LIMITS, float(np.abs(route).max())) <= 1e-9
    m = sampled(trajectory, 1)
    for part in (m.velocity_mps, m.acceleration_mps2):
        assert np.abs(part[[0, -1]]).max() <= 1e-9
    np.testing.assert_allclose(trajectory.positions(trajectory.waypoint_s), route, atol=1e-6)
    assert np.all(np.diff(trajectory.waypoint_s) > 0)
    assert trajectory.waypoint_s[-1] == pytest.approx(trajectory.end_s)


@pytest.mark.slow
@pytest.mark.parametrize("spread", [25.0, 60.0, 120.0, 250.0])
@pytest.mark.parametrize("seed", range(2))
def test_flying_through_beats_stopping(seed, spread):
    """Total time is at most 0.97 of stop-and-go and at least that of straight lines."""
    route = random_route(seed, 10, spread)
    through = smooth_route(RouteRequest(route, LIMITS)).end_s
    stopped = smooth_route(RouteRequest(route, LIMITS, stop=np.ones(10, bool))).end_s
    assert straight_line_s(route, LIMITS) <= through <= 0.97 * stopped


def test_stops_holds_and_caps_are_kept():
    """A stop is at rest, a hold lasts, a photo point is passed no faster than its cap."""
    route = np.array([[0.0, 0, 50], [120, 0, 50], [240, 30, 60], [300, 150, 60], [420, 150, 50]])
    request = RouteRequest(
        route,
        LIMITS,
        stop=np.array([False, True, False, False, False]),
        hold_s=np.array([0, 0, 2.5, 0, 0]),
        cap_mps=np.array([np.inf, np.inf, np.inf, 2.0, np.inf]),
    )
    trajectory = smooth_route(request)
    passed = trajectory.waypoint_s
    speed = np.linalg.norm(trajectory.motion(passed).velocity_mps, axis=1)
    np.testing.assert_allclose(speed[[1, 2]], 0, atol=1e-9)
    assert speed[3] <= 2.0 + 1e-9
    resting = trajectory.motion(passed[2] - np.linspace(0, 2.5, 6))
    np.testing.assert_allclose(resting.position_m, np.tile(route[2], (6, 1)), atol=1e-9)


def test_the_curve_stays_near_the_legs():
    """With a corridor of 3 m the curve is never further than 3 m from the straight legs."""
    route = random_route(3, 9, 120.0)
    tight = smooth_route(RouteRequest(route, LIMITS), SmoothingSettings(corridor_m=3.0))
    motion = sampled(tight, 100)
    start, step = route[:-1], np.diff(route, axis=0)
    offset = motion.position_m[:, None] - start
    share = np.clip(np.sum(offset * step, -1) / np.sum(step * step, -1), 0, 1)
    away = np.linalg.norm(offset - share[..., None] * step, axis=-1).min(axis=1)
    assert away.max() <= 3.0 + 1e-6


def test_repeated_and_single_points():
    """Two photos at one place share the stop; a route of one point rests there."""
    route = np.array([[0.0, 0, 50], [100, 0, 50], [100, 0, 50], [200, 0, 50]])
    trajectory = smooth_route(RouteRequest(route, LIMITS))
    assert trajectory.waypoint_s[1] == trajectory.waypoint_s[2]
    alone = smooth_route(RouteRequest(route[:1], LIMITS))
    np.testing.assert_allclose(alone.positions(np.array([0.0, 5.0])), route[[0, 0]])


def test_vertical_legs_and_drag():
    """Straight climbs and a tilt limit with drag are handled."""
    limits = CurveLimits(8.0, 3.0, 2.0, drag_1ps=0.4, tilt_deg=30.0)
    route = np.array([[0.0, 0, 0], [0, 0, 50], [150, 0, 50], [150, 120, 70], [150, 120, 20]])
    trajectory = smooth_route(RouteRequest(route, limits))
    assert max(ratios_at_samples(trajectory, limits).values()) <= 1.0


@pytest.mark.parametrize(
    ("change", "name"),
    [
        ({"points_m": np.zeros((3, 2))}, "points_m"),
        ({"stop": np.zeros(2, bool)}, "stop"),
        ({"cap_mps": np.zeros(3)}, "cap_mps"),
        ({"hold_s": np.array([0.0, -1, 0])}, "hold_s"),
    ],
)
def test_wrong_requests_are_refused(change, name):
    """A request that contradicts itself raises InputError naming the field."""
    fields = {"points_m": random_route(1, 3), "limits": LIMITS, **change}
    with pytest.raises(InputError, match=name):
        smooth_route(RouteRequest(**fields))
