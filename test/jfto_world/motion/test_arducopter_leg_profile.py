"""Rules of the planner's single legs."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from jfto_world.motion.arducopter.leg_profile import (
    COLUMNS,
    DURATION,
    LENGTH,
    SPEED,
    T_ACC,
    along_leg,
    fill_leg,
    planner_limits,
)
from jfto_world.motion.arducopter.wpnav import WpNav

# As Python runs it; compiled it is a part of others.
along_leg = along_leg.py_func


def leg_of(step, wpnav):
    leg = np.zeros(COLUMNS)
    fill_leg(leg, *map(float, step), planner_limits(wpnav))
    return leg


@pytest.mark.parametrize(
    ("speed", "t_acc", "distance"), [(10.0, 6.8, 34.0), (8.0, 6.0, 24.0), (5.0, 4.8, 12.0)]
)
def test_speed_up_takes_the_measured_time_and_distance(speed, t_acc, distance):
    """Level speed-up with default limits takes 6.8, 6.0, 4.8 s and 34, 24, 12 m."""
    leg = leg_of((1000.0, 0.0, 0.0), WpNav(speed_mps=speed))
    assert leg[T_ACC] == pytest.approx(t_acc, abs=0.05)
    assert along_leg(leg, leg[T_ACC])[0] == pytest.approx(distance, abs=0.5)


@pytest.mark.parametrize(
    ("rise", "horizontal", "seconds"),
    [(30, 100, 28.0), (-30, 100, 42.3), (15, 100, 17.5), (-15, 100, 23.1), (45, 60, 28.2)],
)
def test_slopes_are_bound_by_the_vertical_limits(rise, horizontal, seconds):
    """Stop to stop times on slopes agree with the flights within 0.2 s."""
    leg = leg_of((horizontal, 0.0, horizontal * np.tan(np.radians(rise))), WpNav())
    assert leg[DURATION] == pytest.approx(seconds, abs=0.2)


steps = st.tuples(*[st.floats(-300, 300)] * 3).filter(lambda s: np.linalg.norm(s) > 0.01)
wpnavs = st.builds(
    WpNav,
    speed_mps=st.floats(1, 15),
    speed_up_mps=st.floats(0.5, 8),
    speed_dn_mps=st.floats(0.5, 5),
    accel_mps2=st.floats(0.5, 5),
    accel_z_mps2=st.floats(0.3, 5),
    jerk_mps3=st.floats(0.3, 20),
)


@pytest.mark.slow
@settings(deadline=None, max_examples=60, derandomize=True)
@given(steps, wpnavs)
def test_leg_keeps_its_limits_and_integrates(step, wpnav):
    """Distance is the integral of speed, speed that of acceleration; no limit is exceeded."""
    leg = leg_of(step, wpnav)
    times = np.linspace(0.0, leg[DURATION], 4001)
    x, w, a = np.array([along_leg(leg, t) for t in times]).T
    dt = times[1]
    size = leg[LENGTH]
    assert x[0] == 0
    assert x[-1] == pytest.approx(size)
    np.testing.assert_allclose(
        np.diff(x), dt * (w[1:] + w[:-1]) / 2, atol=wpnav.jerk_mps3 * dt**3 + 1e-9 * size
    )
    np.testing.assert_allclose(
        np.diff(w), dt * (a[1:] + a[:-1]) / 2, atol=wpnav.jerk_mps3 * dt**2 * 3 + 1e-9
    )
    level = np.hypot(step[0], step[1]) / size
    rise = abs(step[2]) / size
    assert w.max() * level <= wpnav.speed_mps * (1 + 1e-9)
    vertical = wpnav.speed_up_mps if step[2] > 0 else wpnav.speed_dn_mps
    assert w.max() * rise <= vertical * (1 + 1e-9)
    assert np.abs(a).max() * level <= wpnav.accel_mps2 * (1 + 1e-9)
    assert np.abs(a).max() * rise <= wpnav.accel_z_mps2 * (1 + 1e-9)
    assert np.abs(np.diff(a)).max() <= wpnav.jerk_mps3 * dt * (1 + 1e-6) + 1e-9


@settings(deadline=None, max_examples=40, derandomize=True)
@given(steps, wpnavs)
def test_leg_reaches_at_least_one_limit(step, wpnav):
    """A leg is as fast as it may be: without room to cruise it never coasts."""
    leg = leg_of(step, wpnav)
    cruise = leg[DURATION] - 2 * leg[T_ACC]
    level = np.hypot(step[0], step[1]) / leg[LENGTH]
    rise = abs(step[2]) / leg[LENGTH]
    vertical = wpnav.speed_up_mps if step[2] > 0 else wpnav.speed_dn_mps
    with np.errstate(divide="ignore"):
        limit = min(wpnav.speed_mps / np.float64(level), vertical / np.float64(rise))
    assert cruise == pytest.approx(0, abs=1e-6) or leg[SPEED] == pytest.approx(limit)


def test_leg_of_no_length_lasts_no_time():
    """Two equal waypoints make a leg of 0 s, not a division by zero."""
    leg = leg_of((0.0, 0.0, 0.0), WpNav())
    assert leg[DURATION] == 0
    assert along_leg(leg, 1.0) == (0.0, 0.0, 0.0)
