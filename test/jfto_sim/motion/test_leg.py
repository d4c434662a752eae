"""A leg whose speed is changed on the way stays smooth and arrives."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from jfto_sim.motion.leg import Leg
from jfto_world.motion.arducopter.leg_profile import planner_limits
from jfto_world.motion.arducopter.wpnav import WpNav


def limits(speed):
    return planner_limits(WpNav(speed_mps=speed))


def sample(leg, step_s=0.01):
    times = np.arange(0.0, leg.duration_s + step_s, step_s)
    return times, np.array([leg.along(t) for t in times])


def test_unchanged_leg_goes_from_rest_to_rest():
    """100 m at 10 m/s: 16.8 s, ends at rest at the destination."""
    leg = Leg((0, 0, 0), (100, 0, 0), limits(10.0))
    assert leg.duration_s == pytest.approx(16.8, abs=0.05)
    assert leg.along(leg.duration_s) == (leg.length_m, 0.0, 0.0)


@given(
    length=st.floats(20.0, 400.0),
    first=st.floats(2.0, 12.0),
    second=st.floats(2.0, 12.0),
    share=st.floats(0.0, 0.9),
)
@settings(deadline=None, max_examples=60, derandomize=True)
def test_changed_leg_is_continuous(length, first, second, share):
    """Position and speed never jump, whatever the moment of the change; the end is at rest."""
    leg = Leg((0, 0, 0), (length, 0, 0), limits(first))
    leg.elapsed_s = share * leg.duration_s
    before = leg.along(leg.elapsed_s)
    leg.change_limits(limits(second))
    after = leg.along(leg.elapsed_s)
    assert after[:2] == pytest.approx(before[:2], abs=1e-6)
    times, motion = sample(leg)
    late = times >= leg.elapsed_s
    assert np.all(np.diff(motion[late, 0]) >= -1e-6)
    assert np.abs(np.diff(motion[late, 1])).max() <= 0.01 * 2.6
    assert motion[late, 1].max() <= max(first, second) + 1e-6
    assert motion[-1, 0] == pytest.approx(length, abs=1e-6)


def test_speed_change_takes_its_time():
    """8 to 5 m/s on a cruising leg takes about 3.5 s, as measured."""
    leg = Leg((0, 0, 0), (400, 0, 0), limits(8.0))
    leg.elapsed_s = 20.0
    leg.change_limits(limits(5.0))
    times, motion = sample(leg)
    slow = times[(motion[:, 1] <= 5.05) & (times > 20.0)][0]
    assert slow - 20.0 == pytest.approx(3.5, abs=0.5)
