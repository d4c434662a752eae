"""Rules of height above ground along the curve."""

import numpy as np
import pytest

from jfto_msgs_py.errors import InfeasibleError, InputError
from jfto_planner.smoothing import (
    Clearance,
    CurveLimits,
    RouteRequest,
    smooth_above,
    smooth_route,
)
from support.curves import least_clearance_m

LIMITS = CurveLimits(8.0, 4.0, 3.0)


def ridge(x, y):
    """A ridge 60 m high across the way at x = 100 m, 25 m wide."""
    return 60.0 * np.exp(-(((x - 100.0) / 25.0) ** 2)) + 0.0 * y


ROUTE = np.array([[0.0, 0, 40], [200, 0, 40], [200, 100, 45], [0, 100, 40]])


def test_a_ridge_between_waypoints_is_flown_over():
    """The plain curve would hit the ridge; the lifted one keeps 20 m and meets all waypoints."""
    request = RouteRequest(ROUTE, LIMITS)
    assert least_clearance_m(smooth_route(request), ridge) < 0
    lifted = smooth_above(request, ridge, Clearance(20.0))
    assert least_clearance_m(lifted, ridge) >= 20.0 - 0.05
    assert lifted.waypoint_s.shape == (4,)
    np.testing.assert_allclose(lifted.positions(lifted.waypoint_s), ROUTE, atol=1e-6)


def test_free_routes_are_not_changed():
    """Where the curve is high enough, it is the one without terrain."""
    request = RouteRequest(ROUTE + np.array([0, 0, 100.0]), LIMITS)
    plain, above = smooth_route(request), smooth_above(request, ridge, Clearance(20.0))
    assert plain.control_m.tobytes() == above.control_m.tobytes()


def test_pads_are_left_and_reached_vertically():
    """From pads on the ground the climb is straight up, and straight down at the end."""
    route = ROUTE.copy()
    route[[0, 3], 2] = ridge(route[[0, 3], 0], route[[0, 3], 1]) + 0.2
    trajectory = smooth_above(RouteRequest(route, LIMITS), ridge, Clearance(15.0))
    times = np.linspace(0, trajectory.end_s, 5000)
    places = trajectory.positions(times)
    above = places[:, 2] - ridge(places[:, 0], places[:, 1])
    low = above < 15.0 - 0.05
    aside = np.minimum(
        np.hypot(*(places[:, :2] - route[0, :2]).T), np.hypot(*(places[:, :2] - route[3, :2]).T)
    )
    assert low.any()
    assert aside[low].max() <= 1e-6


def test_points_that_are_too_low_are_named():
    """An inner photo point below the clearance is infeasible, with its index and height."""
    route = ROUTE.copy()
    route[1, 2] = 5.0
    with pytest.raises(InfeasibleError, match=r"Point 1 of the route is 5\.0 m"):
        smooth_above(RouteRequest(route, LIMITS), ridge, Clearance(20.0))
    with pytest.raises(InputError, match="spacing_m"):
        Clearance(10.0, spacing_m=0.0)
