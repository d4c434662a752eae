"""Topologies with a margin, through whole slots, that energy can pay for."""

from __future__ import annotations

import numpy as np
import pytest

from jfto_topology.algorithms.ctop import ctop
from jfto_topology.links import Links, guarded_gain
from jfto_world.radio import LogDistanceChannel, degrees, mutual_links

# With gain 1 at 1 m and this sensitivity, 1 W reaches 1000 m and p watts √p × 1000 m.
SENSITIVITY_W = 1e-6
CHANNEL = LogDistanceChannel(1.0)
IDS = ("uav1", "uav2", "uav3", "uav4")
NO_ENERGY_KNOWN: dict[str, float] = {}


def links(k_min=1, margin_db=None, loss_db=0.0):
    """Rules for radios of 1 W."""
    caps = dict.fromkeys(IDS, 1.0)
    return Links(CHANNEL, caps, SENSITIVITY_W, k_min, 2, margin_db, loss_db)


def square(side_m, instants):
    """A square of UAVs that stands still, (instants, 4, 3)."""
    corners = side_m * np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
    return np.broadcast_to(corners, (instants, 4, 3)).copy()


def test_without_a_margin_it_is_c_top_at_the_slots_beginnings():
    """The last row, the end of the last slot, is not looked at."""
    places = np.random.default_rng(3).uniform(0, 700, (6, 4, 3))
    found, k_min = links().topology(IDS, places, 3.0, NO_ENERGY_KNOWN)
    plain = ctop(places[:-1], CHANNEL, np.ones(4), SENSITIVITY_W, 1, 2)
    assert k_min == 1
    assert np.array_equal(found.adjacency, plain.adjacency)
    assert found.p_min_w == pytest.approx(plain.p_min_w, rel=1e-9)


def test_a_margin_raises_the_least_powers_by_it():
    """3 dB double them; 2 dB of learned loss add to that."""
    places = square(500.0, 3)
    plain, _ = links(2).topology(IDS, places, 3.0, NO_ENERGY_KNOWN)
    assert plain.p_min_w == pytest.approx(np.full((2, 4), 0.25))
    wide, _ = links(2, 3.0).topology(IDS, places, 3.0, NO_ENERGY_KNOWN)
    assert wide.p_min_w == pytest.approx(np.full((2, 4), 0.25 * 10**0.3))
    lossy, _ = links(2, 3.0, 2.0).topology(IDS, places, 3.0, NO_ENERGY_KNOWN)
    assert lossy.p_min_w == pytest.approx(np.full((2, 4), 0.25 * 10**0.5))


def test_powers_last_through_the_slot_in_which_uavs_part():
    """A pair at 400 m that is 600 m apart at the end of its slot gets what that takes."""
    places = np.zeros((2, 2, 3))
    places[:, 1, 0] = (400.0, 600.0)
    found, _ = links(1, 0.0).topology(IDS[:2], places, 3.0, NO_ENERGY_KNOWN)
    assert found.p_min_w == pytest.approx(np.full((1, 2), 0.36))


def test_a_margin_never_takes_away_a_link_that_is_there():
    """A pair within reach, but not with the margin, keeps its link at full power."""
    gain = np.zeros((2, 2, 2))
    gain[:, 0, 1] = gain[:, 1, 0] = (1.2e-6, 0.9e-6)
    guarded = guarded_gain(gain, np.array([1.0, 2.0]), SENSITIVITY_W, 3.0)
    assert guarded[0, 0, 1] == pytest.approx(1e-6)
    assert mutual_links(guarded, np.ones((1, 2)), SENSITIVITY_W)[0, 0, 1]
    # Beyond reach at the slot's beginning there is nothing to keep.
    out = guarded_gain(gain[::-1], np.array([1.0, 2.0]), SENSITIVITY_W, 3.0)
    assert out[0, 0, 1] < 1e-6


def test_slots_give_way_where_energy_does_not_last_and_no_more_of_them():
    """Half way between the energy of one neighbour and of two, two of five slots keep two."""
    pairs = square(500.0, 6)
    pairs[:, 1] = pairs[:, 0] + [50.0, 0.0, 0.0]
    pairs[:, 3] = pairs[:, 2] + [50.0, 0.0, 0.0]
    rich = dict.fromkeys(IDS, 100.0)
    all_two, k_min = links(2, 0.0).topology(IDS, pairs, 1.0, rich)
    assert k_min == 2
    assert (degrees(all_two.adjacency) >= 2).all()
    cost_j = all_two.p_min_w.sum(axis=0)
    one, _ = links(1, 0.0).topology(IDS, pairs, 1.0, rich)
    middle = (cost_j + one.p_min_w.sum(axis=0)) / 2
    short = rich | {"uav2": float(middle[1])}
    mixed, k_min = links(2, 0.0).topology(IDS, pairs, 1.0, short)
    held = (degrees(mixed.adjacency) >= 2).all(axis=1)
    assert held.sum() == 2
    assert mixed.p_min_w.sum(axis=0)[1] <= middle[1]
    assert mixed.connected.all()
    assert k_min == (2 if held[0] else 1)


def test_the_margin_gives_way_before_a_neighbour_does():
    """Energy for two neighbours without the margin keeps two neighbours."""
    places = square(500.0, 5)
    cost_j = 4 * 0.25
    left_j = dict.fromkeys(IDS, 1.1 * cost_j)
    found, k_min = links(2, 3.0).topology(IDS, places, 1.0, left_j)
    assert k_min == 2
    assert (degrees(found.adjacency) >= 2).all()
    assert (found.p_min_w.sum(axis=0) <= 1.1 * cost_j).all()


def test_a_uav_without_energy_is_nobodys_neighbour():
    """The others find theirs among themselves; it is flagged and gets no links."""
    left_j = dict.fromkeys(IDS, 100.0) | {"uav3": 0.0}
    found, _ = links(1, 0.0).topology(IDS, square(500.0, 3), 1.0, left_j)
    assert not found.adjacency[:, 2].any()
    assert found.deficit[:, 2].all()
    assert (degrees(found.adjacency)[:, [0, 1, 3]] >= 1).all()
    assert not found.connected.any()
