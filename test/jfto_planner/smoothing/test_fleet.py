"""Smoothing a whole fleet."""

from __future__ import annotations

import numpy as np
import pytest

from jfto_msgs_py.errors import InfeasibleError
from jfto_planner.smoothing import (
    Clearance,
    CurveLimits,
    CurveRules,
    kept_apart,
    smooth_fleet,
)
from support.curves import closest_approach_m, least_clearance_m

_LIMITS = CurveLimits(8.0, 4.0, 3.0)
_LINES = (
    np.array([[0.0, 0, 0], [0, 0, 60], [150, 20, 60], [150, 150, 70]]),
    np.array([[20.0, 0, 0]]),
)


def _flat(x_m, y_m):
    return np.zeros(np.broadcast(x_m, y_m).shape)


def test_everybody_keeps_clear_of_the_ground_and_whoever_has_no_route_stays() -> None:
    """Curves stay above the clearance away from the pads; a route of one point is a pad."""
    flown = smooth_fleet(("a", "b"), _LINES, (_LIMITS,) * 2, _flat, CurveRules(Clearance(20.0)))
    away = flown[0].positions(np.linspace(20.0, flown[0].end_s, 200))
    assert least_clearance_m(flown[0], _flat) == pytest.approx(0.0)
    assert away[:, 2].min() > 20.0
    assert np.array_equal(flown[1].positions(np.array([0.0, 30.0])), _LINES[1][[0, 0]])


def test_same_result_on_any_number_of_threads() -> None:
    """Two threads and one give the same bytes."""
    lines = tuple(_LINES[0] + np.array([shift, 0.5 * shift, 0.0]) for shift in (0.0, 40.0, 80.0))
    rules = CurveRules(Clearance(20.0))
    found = [
        smooth_fleet(("a", "b", "c"), lines, (_LIMITS,) * 3, _flat, rules, workers=workers)
        for workers in (1, 2)
    ]
    for one, two in zip(*found, strict=True):
        assert one.control_m.tobytes() == two.control_m.tobytes()
        assert one.duration_s.tobytes() == two.duration_s.tobytes()


def test_the_vehicle_that_cannot_fly_its_route_is_named() -> None:
    """A waypoint below the clearance stops the planning with the vehicle's name."""
    lines = (_LINES[1], np.array([[0.0, 0, 0], [50, 0, 5], [90, 0, 60]]))
    with pytest.raises(InfeasibleError, match=r"^b: Point"):
        smooth_fleet(("a", "b"), lines, (_LIMITS,) * 2, _flat, CurveRules(Clearance(20.0)))


@pytest.mark.slow
def test_a_fleet_that_cannot_be_kept_apart_is_left_for_the_certificate() -> None:
    """Two pads closer than d_min cannot be helped by any delay; nothing is changed or raised."""
    lines = (_LINES[0], _LINES[0] + np.array([3.0, 0, 0]))
    flown = smooth_fleet(("a", "b"), lines, (_LIMITS,) * 2, _flat, CurveRules(Clearance(20.0)))
    same = kept_apart(flown, 10.0, lambda _positions: True)
    assert same == flown
    assert closest_approach_m(same) < 10.0
