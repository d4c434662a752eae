"""Metrics on cases worked out by hand, and against networkx."""

import math

import networkx as nx
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from jfto_msgs_py.errors import InputError
from jfto_msgs_py.records.radio import Radio
from jfto_topology.metrics import (
    average_hops,
    components,
    connectivity_rate,
    energy_used,
    hop_counts,
    largest_component,
    slot_throughput,
)
from jfto_world.radio import noise_w

RADIO = Radio()


def graph(uavs, *pairs, slots=1):
    adjacency = np.zeros((slots, uavs, uavs), dtype=bool)
    for a, b in pairs:
        adjacency[:, a, b] = adjacency[:, b, a] = True
    return adjacency


PATH = graph(4, (0, 1), (1, 2), (2, 3))
RING = graph(4, (0, 1), (1, 2), (2, 3), (3, 0))
SPLIT = graph(4, (0, 1), (2, 3))


@st.composite
def random_graphs(draw):
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    uavs = draw(st.integers(2, 10))
    links = np.triu(rng.random((3, uavs, uavs)) < draw(st.sampled_from([0.2, 0.5, 0.9])), 1)
    return links | links.transpose(0, 2, 1), rng.random((3, uavs)) < 0.8


def test_throughput_of_a_pair_is_the_mean_of_both_directions():
    """3 W and 1 W over the noise give 2 and 1 bit/s/Hz: the pair carries 1.5 B, each pair once."""
    gain = np.full((3, 2, 2), noise_w(RADIO))
    power = np.array([[3.0, 1.0], [3.0, 1.0], [1.0, 1.0]])
    adjacency = graph(2, (0, 1), slots=3)
    per_slot = slot_throughput(adjacency, gain, power, RADIO)
    assert per_slot / RADIO.bandwidth_hz == pytest.approx([1.5, 1.5, 1.0])


def test_pairs_without_a_link_carry_nothing():
    """Power does not count where there is no neighbour."""
    gain = np.ones((1, 3, 3))
    assert slot_throughput(graph(3), gain, np.ones((1, 3)), RADIO).tolist() == [0.0]


def test_arrays_that_do_not_fit_are_refused():
    """Shapes are named, and powers below 0 W are none."""
    links, gain, power = graph(3), np.ones((1, 3, 3)), np.ones((1, 3))
    with pytest.raises(InputError, match=r"adjacency has shape \(3, 3\)"):
        average_hops(links[0])
    with pytest.raises(InputError, match=r"power_w \(3,\)"):
        slot_throughput(links, gain, power[0], RADIO)
    with pytest.raises(InputError, match="negative"):
        slot_throughput(links, gain, -power, RADIO)


def test_connectivity_rate_of_a_path_and_a_ring():
    """Losing an end of a path leaves 3 of 3, an inner UAV 2; a ring loses nobody else."""
    assert connectivity_rate(PATH, 0) == pytest.approx((3 + 2 + 2 + 3) / 4 / 3)
    assert connectivity_rate(RING, 0) == 1


def test_connectivity_rate_counts_from_the_slot_of_the_loss():
    """Slots before n_DC do not matter."""
    later = np.concatenate([graph(4), RING, RING])
    assert connectivity_rate(later, 1) == 1
    assert connectivity_rate(later, 0) == pytest.approx((1 / 3 + 1 + 1) / 3)


def test_depleted_uavs_are_lost_too():
    """With UAV 1 of a ring off the air, losing 0, 1, 2 and 3 leaves 2, 3, 2 and 1 joined."""
    on_air = np.array([[True, False, True, True]])
    # Survivors 2-3, then 2-3-0, then 3-0, then 0 and 2 apart.
    assert connectivity_rate(RING, 0, on_air) == pytest.approx((2 + 3 + 2 + 1) / 4 / 3)
    assert connectivity_rate(RING, 0, np.zeros((1, 4), dtype=bool)) == 0


@pytest.mark.parametrize(("adjacency", "slot"), [(PATH, 1), (PATH, -1)])
def test_connectivity_rate_refuses_what_it_cannot_mean(adjacency, slot):
    """A slot beyond the plan has no connectivity rate."""
    with pytest.raises(InputError):
        connectivity_rate(adjacency, slot)


def test_of_a_fleet_of_one_nobody_is_cut_off():
    """Its metrics are numbers: ξ is 1, and there is no way to hop."""
    assert connectivity_rate(graph(1), 0) == 1
    assert average_hops(graph(1)) == 0


@settings(max_examples=60, deadline=None, derandomize=True)
@given(random_graphs())
def test_components_agree_with_networkx(case):
    """Components and the largest of them among the UAVs present."""
    adjacency, present = case
    label, largest = components(adjacency, present), largest_component(adjacency, present)
    for n in range(len(adjacency)):
        inside = nx.from_numpy_array(adjacency[n]).subgraph(np.flatnonzero(present[n]).tolist())
        groups = {frozenset(group) for group in nx.connected_components(inside)}
        ours = {frozenset(np.flatnonzero(label[n] == k).tolist()) for k in set(label[n]) if k >= 0}
        assert ours == groups
        assert largest[n] == max((len(group) for group in groups), default=0)


def test_average_hops_by_hand():
    """A path of 4 averages 5/3, a ring 4/3; their mean over slots; inf when a slot is split."""
    assert average_hops(PATH) == pytest.approx(5 / 3)
    assert average_hops(RING) == pytest.approx(4 / 3)
    assert average_hops(np.concatenate([PATH, RING])) == pytest.approx(1.5)
    assert average_hops(np.concatenate([RING, SPLIT])) == math.inf
    assert average_hops(graph(1)) == 0


@settings(max_examples=60, deadline=None, derandomize=True)
@given(random_graphs())
def test_hop_counts_agree_with_networkx(case):
    """Shortest paths between all pairs."""
    adjacency, _ = case
    hops = hop_counts(adjacency)
    for n in range(len(adjacency)):
        lengths = dict(nx.all_pairs_shortest_path_length(nx.from_numpy_array(adjacency[n])))
        for a in range(adjacency.shape[1]):
            for b in range(adjacency.shape[1]):
                assert hops[n, a, b] == lengths[a].get(b, -1)


def test_energy_leaves_slot_zero_out():
    """Joules are those of slots 1..N."""
    power = np.array([[9.0, 9.0], [1.0, 0.0], [2.0, 0.5]])
    assert energy_used(power, 2.0).tolist() == [6.0, 1.0]
