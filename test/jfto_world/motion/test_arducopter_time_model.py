"""Rules of the ArduCopter time model behind the common interface."""

import numpy as np
import pytest

from data.timing import flights
from jfto_msgs_py.errors import InputError
from jfto_world.motion import MotionLimits, TimeModel
from jfto_world.motion.arducopter import ArduCopter, WpNav
from jfto_world.motion.arducopter.takeoff import takeoff_height_m, takeoff_s

LIMITS = MotionLimits(speed_mps=10.0, climb_mps=2.5, descent_mps=1.5)


def test_it_is_a_time_model():
    """The class offers what `TimeModel` asks for, with the right shapes."""
    model: TimeModel = ArduCopter()
    route = flights.mission_route()
    assert model.leg_matrix(route, LIMITS).shape == (21, 21)
    arrivals = model.arrivals(route, LIMITS)
    assert arrivals.shape == (21,)
    assert arrivals[0] == 0
    assert model.positions(route, LIMITS, arrivals).shape == (21, 3)


@pytest.mark.parametrize("hold_s", [0.0, 1.0])
@pytest.mark.parametrize("spread_m", [150.0, 400.0])
def test_leg_matrix_estimates_the_makespan(hold_s, spread_m):
    """Matrix entries plus the overhead are within 3 % of the flown time, on average over routes."""
    rng = np.random.default_rng(3)
    model = ArduCopter(hold_s=hold_s)
    errors = []
    for _ in range(10):
        route = rng.uniform(0, spread_m, (18, 3)) * np.array([1.0, 1.0, 0.2])
        estimate = model.leg_matrix(route, LIMITS)[np.arange(17), np.arange(1, 18)].sum()
        estimate += model.overhead_s(LIMITS)
        errors.append(estimate / model.arrivals(route, LIMITS)[-1] - 1)
    assert abs(np.mean(errors)) <= 0.03


def test_positions_meet_the_waypoints_at_arrival():
    """At each arrival the vehicle is near the waypoint; after the last it stays there."""
    model = ArduCopter(hold_s=1.0)
    route = flights.mission_route()
    arrivals = model.arrivals(route, LIMITS)
    where = model.positions(route, LIMITS, arrivals)
    assert np.linalg.norm(where - route, axis=1).max() <= 0.7
    late = model.positions(route, LIMITS, arrivals[-1] + np.array([10.0, 1e4]))
    assert np.linalg.norm(late - route[-1], axis=1).max() <= 0.5


@pytest.mark.parametrize(("height", "seconds"), [(20.0, 12.0), (40.0, 20.0), (60.0, 28.0)])
def test_takeoff_takes_the_measured_time(height, seconds):
    """Take-off ends 4.0 s + height / 2.5 after the start, of which 1.8 s are on the ground."""
    assert takeoff_s(height, 2.5, 1.0) == pytest.approx(seconds - 1.8, abs=0.02)


@pytest.mark.parametrize("height", [0.3, 3.0, 10.0, 60.0])
@pytest.mark.parametrize(("climb", "accel"), [(1.0, 1.0), (5.0, 1.0), (5.0, 2.5), (10.0, 0.5)])
def test_the_climb_is_steady_and_ends_at_its_height(height, climb, accel):
    """From the pad to the height, never down and never faster than it may, whatever its peak."""
    total = takeoff_s(height, climb, accel)
    times = np.linspace(0.0, total, 400)
    heights = takeoff_height_m(height, climb, accel, times)
    np.testing.assert_allclose(heights[[0, -1]], [0.0, height], atol=1e-9)
    rates = np.diff(heights) / times[1]
    assert rates.min() >= 0.0
    assert rates.max() <= 1.5 * climb


def test_takeoff_comes_before_the_first_leg():
    """The climb starts on the pad, ends above it, and delays every arrival by its time."""
    route = np.array([[0.0, 0, 0], [100, 0, 40], [100, 100, 40]])
    model = ArduCopter(takeoff_m=40.0)
    above = route + np.array([[0, 0, 40.0], [0, 0, 0], [0, 0, 0]])
    plain = ArduCopter().arrivals(above, LIMITS)
    climb = takeoff_s(40.0, LIMITS.climb_mps, 1.0)
    np.testing.assert_allclose(model.arrivals(route, LIMITS)[1:], plain[1:] + climb)
    times = np.linspace(0, climb, 200)
    where = model.positions(route, LIMITS, times)
    np.testing.assert_allclose(where[[0, -1]], [[0, 0, 0], [0, 0, 40]], atol=1e-6)
    rates = np.diff(where[:, 2]) / times[1]
    assert rates.min() >= 0
    assert rates.max() == pytest.approx(LIMITS.climb_mps, rel=0.08)


def test_parameters_are_checked_and_round_trip():
    """Nonsense is refused by name; the autopilot's own units come out."""
    with pytest.raises(InputError, match="jerk_mps3"):
        WpNav(jerk_mps3=0.0)
    with pytest.raises(InputError, match="step_s"):
        ArduCopter(step_s=1.0)
    values = WpNav().within(LIMITS).as_parameters()
    assert values["WPNAV_SPEED"] == 1000
    assert values["WPNAV_SPEED_DN"] == 150
