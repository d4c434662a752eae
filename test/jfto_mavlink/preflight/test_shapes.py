"""Room that a path leaves to the figures of a fence."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from jfto_mavlink.preflight.shapes import circle_room_m, inside, polygon_room_m, sampled

SQUARE = np.array([[0.0, 0.0], [100.0, 0.0], [100.0, 100.0], [0.0, 100.0]])
NOTCHED = np.array(
    [[0.0, 0], [100, 0], [100, 100], [60, 100], [60, 20], [40, 20], [40, 100], [0, 100]]
)
PLACE = st.tuples(st.floats(-50, 150), st.floats(-50, 150))


@pytest.mark.parametrize(
    ("path", "inclusion", "room_m"),
    [
        ([[50, 50], [90, 50]], True, 10.0),
        ([[50, 50], [130, 50]], True, -30.0),
        ([[150, 50], [150, 90]], False, 50.0),
        ([[-20, 50], [120, 50]], False, -50.0),
        ([[50, 50]], True, 50.0),
    ],
)
def test_room_is_to_the_edge_and_negative_beyond_it(path, inclusion, room_m):
    """Metres, to the nearest edge or to the farthest point on the wrong side."""
    found = polygon_room_m(np.array(path, float), SQUARE, inclusion=inclusion)
    assert found == pytest.approx(room_m, abs=2.0)


def test_a_leg_across_a_notch_is_outside_though_its_ends_are_in():
    """A fence is not only its corners against waypoints."""
    path = np.array([[20.0, 60.0], [80.0, 60.0]])
    assert polygon_room_m(path, NOTCHED, inclusion=True) < 0


def test_a_sliver_thinner_than_the_samples_is_met():
    """Crossings are exact."""
    sliver = np.array([[50.0, -10.0], [50.2, -10.0], [50.2, 10.0], [50.0, 10.0]])
    path = np.array([[0.3, 0.0], [99.7, 0.0]])
    assert polygon_room_m(path, sliver, inclusion=False) < 0


def test_circles_keep_in_and_out():
    """Inside by the farthest corner, outside by the nearest place of a leg."""
    path = np.array([[-30.0, 40.0], [30.0, 40.0]])
    assert circle_room_m(path, np.zeros(2), 60.0, inclusion=True) == pytest.approx(10.0)
    assert circle_room_m(path, np.zeros(2), 30.0, inclusion=False) == pytest.approx(10.0)
    assert circle_room_m(path, np.zeros(2), 45.0, inclusion=False) < 0


@settings(max_examples=60, deadline=None)
@given(st.lists(PLACE, min_size=2, max_size=6))
def test_no_path_leaves_a_fence_that_has_room_for_it(places):
    """Positive room: every place along the path is on the right side, and as far from the edge."""
    path = np.array(places)
    fine = sampled(path, 0.5)
    keep_in = polygon_room_m(path, NOTCHED, inclusion=True)
    keep_out = polygon_room_m(path, NOTCHED, inclusion=False)
    within = inside(fine, NOTCHED)
    if keep_in > 1e-9:
        assert within.all()
    if keep_out > 1e-9:
        assert not within.any()
    assert keep_in <= 0 or keep_out <= 0
