"""Rules of guided flight behind the common time interface."""

import numpy as np
import pytest

from jfto_planner.smoothing import SmoothFlight
from jfto_world.motion import MotionLimits, TimeModel

LIMITS = MotionLimits(8.0, 4.0, 3.0)


@pytest.mark.parametrize("hold_s", [0.0, 1.0])
def test_leg_matrix_estimates_the_makespan(hold_s):
    """The sum of matrix entries is within 3 % of the flown time, on average over routes."""
    rng = np.random.default_rng(0)
    model: TimeModel = SmoothFlight(hold_s=hold_s)
    errors = []
    for _ in range(8):
        walk = np.cumsum(rng.uniform(-1, 1, (12, 2)), axis=0) * 250.0
        route = np.column_stack([walk, rng.uniform(40, 80, 12)])
        estimate = model.leg_matrix(route, LIMITS)[np.arange(11), np.arange(1, 12)].sum()
        errors.append(estimate / model.arrivals(route, LIMITS)[-1] - 1)
    assert abs(np.mean(errors)) <= 0.03


def test_arrivals_and_positions_agree():
    """At each arrival the vehicle is on the waypoint; the first arrival is 0."""
    route = np.array([[0.0, 0, 40], [90, 20, 50], [60, 130, 60], [200, 160, 45]])
    model = SmoothFlight(others=(("jerk_mps3", 8.0),), cap_mps=3.0)
    arrivals = model.arrivals(route, LIMITS)
    assert arrivals[0] == 0
    np.testing.assert_allclose(model.positions(route, LIMITS, arrivals), route, atol=1e-6)
    late = model.positions(route, LIMITS, arrivals[-1:] + 100)
    np.testing.assert_allclose(late, route[-1:], atol=1e-9)
