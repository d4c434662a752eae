"""How many sorties it takes at least."""

from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from jfto_planner.sorties import least_by_time
from jfto_world.motion import ConstantSpeed, MotionLimits

LIMITS = MotionLimits(10.0, 4.0, 3.0)


def test_the_legs_must_fit_into_the_time():
    """100 waypoints on a line, 100 m apart: 990 s of legs for one UAV of 200 s take five sorties,
    since between sorties a leg is left out.
    """
    line = np.column_stack([100.0 * np.arange(100), np.zeros(100), np.zeros(100)])
    assert least_by_time(line, (LIMITS,), np.array([200.0])) == 5
    assert least_by_time(line, (LIMITS,) * 5, np.full(5, 200.0)) == 1
    assert least_by_time(line, (LIMITS,), np.array([200.0]), stop_s=10.0) == 10


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 10_000), st.integers(1, 3), st.integers(1, 4))
def test_no_routes_do_with_less(seed, uavs, sorties):
    """Any routes there are show that as many sorties as they have are no less than the bound."""
    rng = np.random.default_rng(seed)
    waypoints = rng.uniform(0, 2000, (12, 3)) * [1, 1, 0.1]
    parts = np.array_split(rng.permutation(12), sorties * uavs)
    taken = [ConstantSpeed().arrivals(waypoints[part], LIMITS)[-1] for part in parts if len(part)]
    latest = np.full(uavs, max(taken) + 1e-6)
    assert least_by_time(waypoints, (LIMITS,) * uavs, latest) <= sorties
