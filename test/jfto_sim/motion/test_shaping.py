"""Rules of the shaped target motion."""

import pytest

from jfto_sim.motion.shaping import VerticalTarget
from jfto_world.motion.arducopter.takeoff import SPOOL_UP_S, takeoff_s

_STEP_S, _JERK_MPS3 = 0.0025, 5.0
# The simulator's motors spin up for so long before the target leaves the pad.
_SPOOL_S = 0.9


@pytest.mark.parametrize("height_m", [5.0, 10.0, 20.0, 60.0])
@pytest.mark.parametrize(
    ("climb_mps", "accel_mps2"), [(2.5, 1.0), (4.0, 1.0), (5.0, 1.0), (5.0, 2.5)]
)
def test_a_takeoff_ends_when_plans_have_it_end(height_m, climb_mps, accel_mps2):
    """The simulated climb and the closed form that plans are timed by agree within 0.35 s."""
    target, steps = VerticalTarget(), 0
    while target.height_m < 0.9 * height_m or target.climb_mps >= 0.1 * climb_mps:
        target.towards_height(height_m, (climb_mps, 1.5), accel_mps2, _JERK_MPS3, _STEP_S)
        steps += 1
    flown_s = _SPOOL_S + steps * _STEP_S - SPOOL_UP_S
    assert takeoff_s(height_m, climb_mps, accel_mps2) == pytest.approx(flown_s, abs=0.35)
