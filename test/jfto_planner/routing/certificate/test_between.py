"""Separation between instants."""

from dataclasses import replace

import numpy as np
import pytest

from jfto_planner.routing.certificate.between import check_between
from jfto_planner.routing.certificate.routes import fly
from jfto_world.motion import MotionLimits


@pytest.fixture(name="passing")
def _passing(make_problem, make_plan):
    """Two missions that meet head-on, 9 m beside each other, between instants 10 s apart."""
    problem = make_problem(
        waypoints_m=np.array([[200.0, 0, 50], [0, 9, 50]]),
        starts_m=np.array([[0.0, 0, 50], [200, 9, 50], [0, 300, 0], [0, 400, 0]]),
        limits=(MotionLimits(10.0, 4.0, 3.0),) * 4,
        slot_count=2,
    )
    plan = make_plan(problem, ((0,), (1,), (), ()))
    return replace(plan, time_model="arducopter", time_parameters={})


def test_who_meets_between_instants_is_found(passing):
    """At every instant they are far apart; the chord gives them away, finer flight says how far."""
    plan = replace(passing, d_min_m=9.5)
    flown = fly(plan, 1)
    apart = np.linalg.norm(flown.positions_m[:, 0] - flown.positions_m[:, 1], axis=1)
    assert apart.min() > 12.0
    (violation,), worst_m = check_between(plan, flown.positions_m)
    assert (violation.kind, violation.uav) == ("separation", "uav1+uav2")
    assert violation.value == pytest.approx(9.0, abs=0.02)
    assert violation.time_s == pytest.approx(flown.arrivals_s[0][-1] / 2, abs=0.5)
    assert worst_m == violation.value


def test_who_is_far_enough_between_instants_is_let_pass(passing):
    """9 m where 8.5 m are wanted; and at constant speed only slots count."""
    plan = replace(passing, d_min_m=8.5)
    assert check_between(plan, fly(plan, 1).positions_m)[0] == []
    published = replace(passing, d_min_m=9.5, time_model="constant_speed")
    assert check_between(published, fly(published, 1).positions_m) == ([], np.inf)
