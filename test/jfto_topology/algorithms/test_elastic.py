"""The elastic topology against its rules, Algorithm 2, and for small fleets all sets of links."""

from itertools import product

import networkx as nx
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from jfto_msgs_py.errors import InputError
from jfto_topology.algorithms.ctop import ctop_of_gain
from jfto_topology.algorithms.elastic import Air, ctop_elastic
from jfto_topology.algorithms.exchange import Costs, carried
from jfto_topology.algorithms.intervals import ring_powers
from jfto_topology.algorithms.required_power import required_powers_of_gain
from jfto_world.radio import mutual_links, pairwise_distances
from support.radio_fleets import CHANNEL, SENSITIVITY_W, fleets

NOISE_W = 1e-14


def air_of(positions, caps_w):
    return Air(CHANNEL.gain(pairwise_distances(positions)), caps_w, SENSITIVITY_W, NOISE_W)


def bits(active, air):
    """What links carry at the greatest powers of their intervals, bit/s/Hz by slot."""
    required_w = required_powers_of_gain(air.gain, air.p_max_w, air.sensitivity_w)
    costs = Costs(required_w, ring_powers(required_w), air.p_max_w, air.gain / NOISE_W)
    return carried(active, costs)


@settings(max_examples=120, deadline=None, derandomize=True)
@given(fleets())
def test_degrees_and_connection_are_those_that_the_rules_allow(fleet):
    """Between K_min, or all there are, and K_min + δ; as connected as the caps allow."""
    positions, caps_w, k_min, delta = fleet
    air = air_of(positions, caps_w)
    top = ctop_elastic(air, k_min, delta)
    possible = mutual_links(air.gain, np.broadcast_to(caps_w, top.p_min_w.shape), SENSITIVITY_W)
    degree, most = top.adjacency.sum(axis=2), k_min + delta
    assert np.array_equal(top.adjacency, top.adjacency.transpose(0, 2, 1))
    assert not (top.adjacency & ~possible).any()
    assert np.array_equal(top.deficit, possible.sum(axis=2) < k_min)
    assert (degree >= np.minimum(k_min, possible.sum(axis=2))).all()
    assert np.array_equal(top.over_degree, degree > most)
    for n in range(len(positions)):
        graph = nx.from_numpy_array(top.adjacency[n])
        whole = nx.number_connected_components(nx.from_numpy_array(possible[n]))
        assert nx.number_connected_components(graph) == whole
        assert top.connected[n] == (whole == 1)
        bridges = {frozenset(ends) for ends in nx.bridges(graph)}
        for a in np.flatnonzero(top.over_degree[n]):
            # Nobody is above it where a link could be spared.
            assert all(graph.degree[b] <= k_min or frozenset((a, b)) in bridges for b in graph[a])


@settings(max_examples=100, deadline=None, derandomize=True)
@given(fleets(), st.integers(0, 2**32 - 1))
def test_any_power_inside_the_intervals_gives_the_same_links(fleet, seed):
    """Powers drawn from the intervals, and both their ends, make exactly the stated reach."""
    positions, caps_w, k_min, delta = fleet
    air = air_of(positions, caps_w)
    top = ctop_elastic(air, k_min, delta)
    assert not (top.adjacency & ~top.reach).any()
    rng = np.random.default_rng(seed)
    shares = [np.zeros(top.p_min_w.shape), np.ones(top.p_min_w.shape)]
    for share in [*shares, *rng.uniform(0, 1, (6, *top.p_min_w.shape))]:
        power = top.p_min_w + share * (top.p_upper_w - top.p_min_w)
        assert np.array_equal(mutual_links(air.gain, power, SENSITIVITY_W), top.reach)


@settings(max_examples=100, deadline=None, derandomize=True)
@given(fleets())
def test_it_carries_at_least_what_algorithm_2_does(fleet):
    """In every slot, and the kernel's sum is the rate formula's."""
    positions, caps_w, k_min, delta = fleet
    air = air_of(positions, caps_w)
    top = ctop_elastic(air, k_min, delta)
    literal = ctop_of_gain(air.gain, caps_w, SENSITIVITY_W, k_min, delta)
    ours = bits(top.adjacency, air)
    # A list that could not be trimmed may carry more than the rule allows to list.
    fair = ~literal.over_degree.any(axis=1)
    assert (ours[fair] >= bits(literal.adjacency, air)[fair] * (1 - 1e-12)).all()
    rate = np.log2(1 + top.p_upper_w[:, :, None] * air.gain / NOISE_W)
    assert ours == pytest.approx(np.where(top.adjacency, rate, 0).sum(axis=(1, 2)) / 2, rel=1e-9)


@settings(max_examples=80, deadline=None, derandomize=True)
@given(fleets(), st.floats(1.0, 3.0))
def test_what_algorithm_2_can_pay_for_can_be_paid_for(fleet, share):
    """A budget from just what Algorithm 2 needs on: the least powers never cost more than it."""
    positions, caps_w, k_min, delta = fleet
    air = air_of(positions, caps_w)
    literal = ctop_of_gain(air.gain, caps_w, SENSITIVITY_W, k_min, delta)
    energy_j = literal.p_min_w.sum(axis=0) * 2.0 * share
    top = ctop_elastic(air, k_min, delta, energy_j, 2.0)
    assert (top.p_min_w.sum(axis=0) * 2.0 <= energy_j * (1 + 1e-12)).all()


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(6))
def test_it_is_within_a_tenth_of_the_best_of_all_choices(seed):
    """Five UAVs have ten links at most: every set of them is tried."""
    rng = np.random.default_rng(seed)
    positions = rng.uniform(0, 900, (6, 5, 3)) * [1, 1, 0.1]
    air = air_of(positions, CHANNEL.required_power(rng.uniform(700, 1300, 5), SENSITIVITY_W))
    top = ctop_elastic(air, 1, 1)
    ours = bits(top.adjacency, air)
    possible = np.isfinite(required_powers_of_gain(air.gain, air.p_max_w, SENSITIVITY_W))
    first, second = np.triu_indices(5, 1)
    best = np.zeros(6)
    for chosen in product((False, True), repeat=10):
        links = np.zeros((5, 5), dtype=bool)
        links[first, second] = links[second, first] = chosen
        degree, graph = links.sum(axis=1), nx.from_numpy_array(links)
        if degree.min() < 1 or degree.max() > 2 or not nx.is_connected(graph):
            continue
        allowed = (possible | ~links).all(axis=(1, 2))
        worth = bits(np.broadcast_to(links, (6, 5, 5)).copy(), air)
        best = np.where(allowed, np.maximum(best, worth), best)
    # Where somebody is a bridge to more than two, no set within the rule exists.
    kept = ~top.over_degree.any(axis=1)
    assert (ours[kept] <= best[kept] * (1 + 1e-12)).all()
    assert (ours[kept] >= 0.9 * best[kept]).all()
    assert ours[kept].sum() >= 0.97 * best[kept].sum()


@pytest.mark.parametrize(
    ("noise_w", "energy_j", "said"),
    [(0.0, None, "noise_w"), (float("nan"), None, "noise_w"), (1.0, np.ones(3), r"\(2,\)")],
)
def test_senseless_arguments_are_refused(noise_w, energy_j, said):
    """Noise is a positive power, and there is one budget for each UAV."""
    air = Air(np.ones((1, 2, 2)), np.ones(2), 1.0, noise_w)
    with pytest.raises(InputError, match=said):
        ctop_elastic(air, 1, 1, energy_j)
