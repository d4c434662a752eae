"""Rules of spline missions in time; recorded ones are met in test_arducopter_closed_loop."""

import numpy as np
import pytest

from jfto_msgs_py.errors import InfeasibleError, InputError
from jfto_world.motion.arducopter import WpNav, fly_route
from support.spline_flight import fly_splines

ROUTE = np.array([[0.0, 0, 50], [100, 0, 50], [150, 80, 60], [60, 120, 40]])


def test_a_straight_spline_speeds_up_at_half_of_the_acceleration():
    """200 m from rest to rest at 8 m/s and 1.25 m/s²: 200 / 8 + 8 / 1.25 s, and a second of lag."""
    flight = fly_splines(np.array([[0.0, 0, 50], [200, 0, 50]]), WpNav(speed_mps=8.0))
    assert 31.4 < flight.reached_s[1] < 32.5


def test_the_target_passes_through_every_waypoint():
    """Each waypoint lies on the target's way, and is counted when the target is there."""
    flight = fly_splines(ROUTE, WpNav(speed_mps=8.0))
    at = np.round(flight.reached_s[1:] / flight.step_s).astype(int)
    away = np.linalg.norm(flight.target_m[at] - ROUTE[1:], axis=1)
    assert away.max() < 0.3


def test_splines_are_slower_than_straight_legs():
    """The reason why missions of ours have none."""
    wpnav = WpNav(speed_mps=8.0)
    assert fly_splines(ROUTE, wpnav).reached_s[-1] > fly_route(ROUTE, wpnav).reached_s[-1]


def test_points_that_make_no_spline_are_refused():
    """One point, or the same point twice in a row, raises InputError."""
    with pytest.raises(InputError, match="each off the one before"):
        fly_splines(ROUTE[:1], WpNav())
    with pytest.raises(InputError, match="each off the one before"):
        fly_splines(ROUTE[[0, 1, 1, 2]], WpNav())


def test_unreachable_wind_is_said():
    """A head wind beyond the tilt limit raises InfeasibleError and names the wind."""
    with pytest.raises(InfeasibleError, match="wind of 25"):
        fly_splines(ROUTE, WpNav(), wind_mps=(-25.0, 0.0))
