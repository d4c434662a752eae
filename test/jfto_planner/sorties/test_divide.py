"""Waypoints into groups: each in one, together on the map, of about equal weight."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from jfto_msgs_py.errors import InputError
from jfto_planner.sorties import divide

PLACE = st.tuples(*2 * (st.floats(-5e3, 5e3).map(lambda value: round(value, 3)),))


@settings(max_examples=150, deadline=None)
@given(st.lists(PLACE, min_size=1, max_size=60), st.data())
def test_every_waypoint_is_in_one_sortie(places, data):
    """Whatever the places, equal ones included: none is lost or doubled, no group is empty."""
    count = data.draw(st.integers(1, len(places)))
    weights = data.draw(st.lists(st.floats(0.1, 10.0), min_size=len(places), max_size=len(places)))
    groups = divide(np.array(places), weights, count)
    assert len(groups) == count
    assert min(map(len, groups)) >= 1
    assert sorted(np.concatenate(groups).tolist()) == list(range(len(places)))
    again = divide(np.array(places), weights, count)
    assert all(np.array_equal(a, b) for a, b in zip(groups, again, strict=True))


@pytest.mark.parametrize("count", [2, 3, 5, 8])
def test_groups_of_an_even_area_are_equal_and_compact(count):
    """Of 900 waypoints on a square each group has its share, and none lies scattered."""
    places = np.stack(np.meshgrid(np.arange(30.0), np.arange(30.0)), axis=-1).reshape(-1, 2)
    groups = divide(100 * places, np.ones(900), count)
    assert max(map(len, groups)) - min(map(len, groups)) <= 2
    for group in groups:
        spread = np.ptp(places[group], axis=0) + 1
        assert np.prod(spread) <= 1.3 * len(group)


def test_heavy_waypoints_make_small_groups():
    """What weighs three times as much is a quarter of the waypoints to the others' three."""
    places = np.column_stack([np.arange(40.0), np.zeros(40)])
    west, east = divide(places, np.where(np.arange(40) < 10, 3.0, 1.0), 2)
    assert (west.tolist(), len(east)) == ([*range(10)], 30)


def test_more_sorties_than_waypoints_are_refused():
    """The message says how many there are."""
    with pytest.raises(InputError, match="3 waypoints cannot be divided into 4 sorties"):
        divide(np.zeros((3, 3)), np.ones(3), 4)
