"""Rules of trajectories as records and in time."""

import json

import numpy as np
import pytest

from jfto_msgs_py.errors import InputError
from jfto_planner.smoothing import (
    CurveLimits,
    RouteRequest,
    Trajectory,
    photo_speed_mps,
    smooth_route,
)
from support.curves import limit_ratios, sampled

LIMITS = CurveLimits(8.0, 3.0, 2.0)
ROUTE = np.array([[0.0, 0, 40], [90, 20, 50], [60, 130, 60], [200, 160, 45]])


@pytest.fixture(scope="module")
def flown():
    return smooth_route(RouteRequest(ROUTE, LIMITS))


def test_derivatives_integrate(flown):
    """Velocity, acceleration and jerk are each other's derivatives."""
    times = np.linspace(0.0, flown.end_s, 40_001)
    m = flown.motion(times)
    dt = times[1]
    pairs = ((m.position_m, m.velocity_mps), (m.velocity_mps, m.acceleration_mps2))
    for value, slope in pairs:
        np.testing.assert_allclose(
            np.diff(value, axis=0), dt * (slope[1:] + slope[:-1]) / 2, atol=10 * dt**2
        )


def test_rest_before_and_after(flown):
    """Before its delay and after its end the vehicle rests at the ends of the route."""
    late = flown.delayed(4.0)
    m = late.motion(np.array([0.0, 3.9, late.end_s + 1.0, 1e6]))
    np.testing.assert_allclose(m.position_m, ROUTE[[0, 0, -1, -1]], atol=1e-9)
    assert not m.velocity_mps.any()
    assert late.end_s == pytest.approx(flown.end_s + 4.0)
    np.testing.assert_allclose(late.positions(late.waypoint_s), ROUTE, atol=1e-6)


def test_slowing_keeps_the_path_and_the_limits(flown):
    """Half the speed: same places at twice the time, every limit still kept."""
    slow = flown.delayed(1.0).slowed(2.0)
    times = np.linspace(0, flown.end_s, 50)
    np.testing.assert_allclose(slow.positions(1.0 + 2 * times), flown.positions(times), atol=1e-9)
    before, after = limit_ratios(flown, LIMITS), limit_ratios(slow, LIMITS)
    assert all(after[name] <= before[name] + 1e-12 for name in before)
    np.testing.assert_allclose(slow.positions(slow.waypoint_s), ROUTE, atol=1e-6)


def test_record_survives_json(flown):
    """Writing to JSON and reading back gives the same bytes; other records are refused."""
    record = json.loads(json.dumps(flown.delayed(0.5).as_record()))
    back = Trajectory.from_record(record)
    assert back.control_m.tobytes() == flown.control_m.tobytes()
    assert back.delay_s == 0.5
    with pytest.raises(InputError, match="kind"):
        Trajectory.from_record({"kind": "spline"})
    with pytest.raises(InputError, match="control_m"):
        Trajectory.from_record({**record, "duration_s": [1.0]})


def test_hull_bounds_the_samples(flown):
    """The hull's bound is never below what samples show, and closes in with halvings."""
    m = sampled(flown, 500)
    jerk = np.linalg.norm(m.jerk_mps3, axis=1).max() / LIMITS.jerk_mps3
    coarse, fine = (limit_ratios(flown, LIMITS, halvings=n)["jerk"] for n in (0, 6))
    assert jerk <= fine * (1 + 1e-6)
    assert fine <= coarse * (1 + 1e-9)
    assert fine == pytest.approx(jerk, rel=1e-3)


def test_wrong_numbers_are_refused(flown):
    """Negative delays, speeding up and impossible limits raise InputError by name."""
    with pytest.raises(InputError, match="delay_s"):
        flown.delayed(-1.0)
    with pytest.raises(InputError, match="factor"):
        flown.slowed(0.5)
    with pytest.raises(InputError, match="jerk_mps3"):
        CurveLimits(8, 3, 2, jerk_mps3=0)
    with pytest.raises(InputError, match="tilt"):
        CurveLimits(15, 3, 2, drag_1ps=0.5)


def test_photo_speed():
    """2 cm pixels, half a pixel of blur and 1/500 s allow 5 m/s."""
    assert photo_speed_mps(0.02, 0.5, 1 / 500) == pytest.approx(5.0)
    with pytest.raises(InputError, match="exposure_s"):
        photo_speed_mps(0.02, 0.5, 0.0)
