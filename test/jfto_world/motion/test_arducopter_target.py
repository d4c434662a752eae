"""Rules of the planner's target along a route."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from data.timing import flights
from jfto_msgs_py.errors import InputError
from jfto_world.motion.arducopter import WpNav, plan_target

RUNS = flights.runs()
STRAIGHT = [name for name in RUNS if not name.startswith("c")]  # the c flights are splines


@pytest.mark.parametrize("name", STRAIGHT)
def test_legs_equal_the_stepping_planner(name):
    """The closed form agrees with a 400 Hz stepping planner within 0.04 s on every leg."""
    parameters, _, planner, _ = RUNS[name]
    hold = np.full(21, 1.0) if name.startswith("d") else None
    track = plan_target(flights.mission_route(), flights.wpnav_of(parameters), hold_s=hold)
    np.testing.assert_allclose(np.diff(track.reached_s), planner, atol=0.04)


def route_of(seed, count, size):
    rng = np.random.default_rng(seed)
    return rng.uniform(-1, 1, (count, 3)) * np.array([size, size, 0.4 * size])


@settings(deadline=None, max_examples=30, derandomize=True)
@given(st.integers(0, 10_000), st.integers(2, 12), st.floats(3.0, 200.0))
def test_target_moves_continuously_within_the_corner_radius(seed, count, size):
    """Velocity integrates to position, the path passes each corner within the radius."""
    wpnav = WpNav()
    route = route_of(seed, count, size)
    track = plan_target(route, wpnav)
    times = np.linspace(0.0, track.duration_s, 20_001)
    place, speed, accel = track.motion(times)
    dt = times[1]
    np.testing.assert_allclose(
        np.diff(place, axis=0), dt * (speed[1:] + speed[:-1]) / 2, atol=dt**2
    )
    np.testing.assert_allclose(
        np.diff(speed, axis=0), dt * (accel[1:] + accel[:-1]) / 2, atol=dt**2
    )
    np.testing.assert_allclose(place[[0, -1]], route[[0, -1]], atol=1e-6)
    at_corner = track.positions(track.reached_s)
    assert np.all(np.linalg.norm(at_corner - route, axis=1) <= wpnav.radius_m + 1e-6)
    assert np.hypot(speed[:, 0], speed[:, 1]).max() <= wpnav.speed_mps * 1.02


def test_hold_rests_at_the_waypoint():
    """With a hold the target stands still on the waypoint for exactly that long."""
    route = np.array([[0.0, 0, 50], [100, 0, 50], [100, 100, 60]])
    track = plan_target(route, WpNav(), hold_s=np.array([0.0, 3.0, 0.0]))
    _, speed, _ = track.motion(track.reached_s[1] - np.array([2.9, 1.5, 0.1]))
    np.testing.assert_allclose(
        track.positions(track.reached_s[1] - np.array([2.9, 0.1])), route[[1, 1]]
    )
    assert np.abs(speed).max() < 1e-9


def test_straight_on_is_not_slowed_much():
    """A waypoint on a straight line costs less than a stop there, and more than none."""
    wpnav = WpNav()
    one = plan_target(np.array([[0.0, 0, 50], [300, 0, 50]]), wpnav).duration_s
    points = np.array([[0.0, 0, 50], [150, 0, 50], [300, 0, 50]])
    through = plan_target(points, wpnav).duration_s
    stopped = plan_target(points, wpnav, stop=np.array([False, True, False])).duration_s
    assert one - 1e-9 <= through < stopped - 1


def test_repeated_points_and_single_points_are_harmless():
    """Equal neighbours and routes of one point give finite times."""
    assert plan_target(np.zeros((1, 3)), WpNav()).duration_s == 0
    route = np.array([[0.0, 0, 0], [0, 0, 0], [50, 0, 0], [50, 0, 0]])
    track = plan_target(route, WpNav())
    assert np.all(np.isfinite(track.reached_s))
    np.testing.assert_allclose(track.positions(np.array([1e6])), route[-1:])


@pytest.mark.parametrize("bad", [np.zeros(3), np.zeros((0, 3)), np.full((2, 3), np.nan)])
def test_wrong_routes_are_refused(bad):
    """A route that is not (M, 3) finite numbers raises InputError."""
    with pytest.raises(InputError):
        plan_target(bad, WpNav())
