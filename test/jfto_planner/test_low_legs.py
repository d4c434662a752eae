"""Rules of legs that pass too near the ground."""

import numpy as np

from jfto_planner.low_legs import low_legs

RIDGE = [[-200.0, 0, 60], [200.0, 0, 60], [-200.0, 300, 60]]


def ridge(x_m, y_m):
    """50 m high along x = 0 where y is below 100 m."""
    return np.where(y_m < 100.0, np.maximum(0.0, 50.0 - np.abs(x_m)), 0.0)


def test_a_leg_across_a_ridge_is_closed_in_both_directions():
    """60 m of height leave 10 m over the ridge: closed at 15 m of clearance, open at 8."""
    nodes, pads = np.array(RIDGE), np.zeros((0, 3))
    low = low_legs(nodes, pads, ridge, 15.0, 5.0)
    assert low.tolist() == [[False, True, False], [True, False, False], [False, False, False]]
    assert not low_legs(nodes, pads, ridge, 8.0, 5.0).any()


def test_a_first_leg_needs_little_until_it_is_high_enough():
    """From 10 m over a pad on flat ground the way up is open; through the ridge it is closed."""
    pads = np.array([[-300.0, 0, 10.0]])
    low = low_legs(np.array(RIDGE), pads, ridge, 15.0, 5.0)
    assert low[3].tolist() == [False, True, False, False]
    assert low[:, 3].tolist() == low[3].tolist()
