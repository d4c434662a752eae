"""C-TOP against its definitions and against a slow, literal Algorithm 2."""

import networkx as nx
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from jfto_msgs_py.errors import InputError
from jfto_topology.algorithms.ctop import ctop, ctop_of_gain, energy_floor
from jfto_world.radio import mutual_links, pairwise_distances
from support.radio_fleets import CHANNEL, SENSITIVITY_W, fleets, power_for


def on_a_line(*x_m):
    return np.array([[[x, 0.0, 0.0] for x in x_m]])


def run(positions, caps_m, k_min=2, delta=2):
    return ctop(positions, CHANNEL, power_for(np.asarray(caps_m)), SENSITIVITY_W, k_min, delta)


def slow_algorithm_2(positions, p_max, k_min):
    """One slot of Algorithm 2, literally: lists by distance rank, repaired step by step."""
    count = len(positions)
    distance = np.linalg.norm(positions[:, None] - positions[None], axis=2)
    reach = np.minimum.outer(p_max, p_max) * CHANNEL.gain(distance) >= SENSITIVITY_W
    order = [
        sorted(
            (b for b in range(count) if b != a and reach[a, b]), key=lambda b: (distance[a, b], b)
        )
        for a in range(count)
    ]

    def closed(a, rank):
        """Extend a rank over all that are no farther than its last one."""
        ranked = order[a]
        while 0 < rank < len(ranked) and power_for(distance[a, ranked[rank]]) <= power_for(
            distance[a, ranked[rank - 1]]
        ) * (1 + 1e-9):
            rank += 1
        return rank

    rank = [closed(a, min(k_min, len(order[a]))) for a in range(count)]

    def raise_to(a, b):
        rank[a] = max(rank[a], closed(a, order[a].index(b) + 1))

    def repair():
        while True:
            one_way = [
                (a, b)
                for a in range(count)
                for b in order[a][: rank[a]]
                if a not in order[b][: rank[b]]
            ]
            if not one_way:
                return
            raise_to(one_way[0][1], one_way[0][0])

    repair()
    while True:
        graph = nx.Graph([(a, b) for a in range(count) for b in order[a][: rank[a]]])
        graph.add_nodes_from(range(count))
        missing = [
            (distance[a, b], a, b)
            for a in range(count)
            for b in order[a]
            if a < b and not nx.has_path(graph, a, b)
        ]
        if not missing:
            break
        _, a, b = min(missing)
        raise_to(a, b)
        raise_to(b, a)
        repair()
    low = [power_for(distance[a, order[a][rank[a] - 1]]) if rank[a] else 0.0 for a in range(count)]
    bound = [
        power_for(distance[a, order[a][rank[a]]]) if rank[a] < len(order[a]) else p_max[a]
        for a in range(count)
    ]
    return nx.to_numpy_array(graph, nodelist=range(count)) > 0, low, bound


@settings(max_examples=120, deadline=None, derandomize=True)
@given(fleets())
def test_lists_and_intervals_equal_a_literal_algorithm_2(fleet):
    """Before trimming, links, P_min and P_max are those of Algorithm 2 done step by step."""
    positions, caps_w, k_min, _ = fleet
    fast = ctop(positions, CHANNEL, caps_w, SENSITIVITY_W, k_min, positions.shape[1])
    for n in range(len(positions)):
        links, low, bound = slow_algorithm_2(positions[n], caps_w, k_min)
        assert np.array_equal(fast.adjacency[n], links)
        assert fast.p_min_w[n] == pytest.approx(low, rel=1e-8)
        assert fast.p_max_w[n] == pytest.approx(bound, rel=1e-8)


@settings(max_examples=150, deadline=None, derandomize=True)
@given(fleets(), st.integers(0, 2**32 - 1))
def test_any_power_inside_the_intervals_gives_the_same_links(fleet, seed):
    """Powers drawn from [P_min, P_max), and both its ends, make exactly the stated reach."""
    positions, caps_w, k_min, delta = fleet
    top = ctop(positions, CHANNEL, caps_w, SENSITIVITY_W, k_min, delta)
    gain = CHANNEL.gain(pairwise_distances(positions))
    rng = np.random.default_rng(seed)
    shares = [np.zeros(top.p_min_w.shape), np.ones(top.p_min_w.shape)]
    shares += list(rng.uniform(0, 1, (6, *top.p_min_w.shape)))
    shares += list(rng.integers(0, 2, (4, *top.p_min_w.shape)))
    for share in shares:
        power = top.p_min_w + share * (top.p_upper_w - top.p_min_w)
        assert np.array_equal(mutual_links(gain, power, SENSITIVITY_W), top.reach)
    assert (top.p_min_w <= top.p_upper_w).all()
    assert (top.p_upper_w <= top.p_max_w).all()
    assert (top.p_max_w <= caps_w).all()
    # Only a UAV whose next candidate is out of reach may be left without room below its cap.
    assert ((top.p_min_w < top.p_max_w) | (top.p_max_w == caps_w)).all()


@settings(max_examples=150, deadline=None, derandomize=True)
@given(fleets())
def test_links_are_mutual_connected_and_numerous_enough(fleet):
    """C is symmetric, connected and K_min strong wherever P_max allows, else flagged."""
    positions, caps_w, k_min, delta = fleet
    top = ctop(positions, CHANNEL, caps_w, SENSITIVITY_W, k_min, delta)
    gain = CHANNEL.gain(pairwise_distances(positions))
    possible = mutual_links(gain, np.broadcast_to(caps_w, top.p_min_w.shape), SENSITIVITY_W)
    degree = top.adjacency.sum(axis=2)
    assert np.array_equal(top.adjacency, top.adjacency.transpose(0, 2, 1))
    assert not (top.adjacency & ~top.reach).any()
    assert not (top.reach & ~possible).any()
    assert np.array_equal(top.deficit, possible.sum(axis=2) < k_min)
    assert (degree >= np.minimum(k_min, possible.sum(axis=2))).all()
    for n in range(len(positions)):
        whole = nx.number_connected_components(nx.from_numpy_array(possible[n]))
        assert nx.number_connected_components(nx.from_numpy_array(top.adjacency[n])) == whole
        assert top.connected[n] == (whole == 1)


@pytest.mark.slow
@settings(max_examples=150, deadline=None, derandomize=True)
@given(fleets())
def test_trimming_leaves_an_excess_only_where_nothing_can_be_spared(fleet):
    """A UAV above K_min + δ is flagged, and each of its links is a bridge or a neighbour's last."""
    positions, caps_w, k_min, delta = fleet
    top = ctop(positions, CHANNEL, caps_w, SENSITIVITY_W, k_min, delta)
    degree = top.adjacency.sum(axis=2)
    assert np.array_equal(top.over_degree, degree > k_min + delta)
    assert (degree <= top.degree_before_trim).all()
    untouched = (top.degree_before_trim <= k_min + delta).all(axis=1)
    assert np.array_equal(degree[untouched], top.degree_before_trim[untouched])
    for n, a in np.argwhere(top.over_degree):
        graph = nx.from_numpy_array(top.adjacency[n])
        bridges = {frozenset(ends) for ends in nx.bridges(graph)}
        for b in graph[a]:
            assert graph.degree[b] <= k_min or frozenset((a, b)) in bridges


@settings(max_examples=60, deadline=None, derandomize=True)
@given(fleets())
def test_energy_floor_is_the_sum_of_least_powers(fleet):
    """The floor equals Σ P_min Δt of C-TOP over slots 1..N; slot 0 is free."""
    positions, caps_w, k_min, delta = fleet
    top = ctop(positions, CHANNEL, caps_w, SENSITIVITY_W, k_min, delta)
    floor = energy_floor(
        positions,
        2.5,
        channel=CHANNEL,
        p_max_w=caps_w,
        sensitivity_w=SENSITIVITY_W,
        k_min=k_min,
        delta=delta,
    )
    assert floor == pytest.approx(top.p_min_w[1:].sum(axis=0) * 2.5)


def test_powers_of_a_line_by_hand():
    """UAVs at 0, 100, 290, 600 m, K_min 1: lists, repair by rank and bounds as worked out by hand.

    Lists: 0→1, 1→0, 2→1, 3→2. For 3, UAV 2 rises to 310 m, which takes in UAV 0; UAV 0 answers at
    290 m and UAV 1 at 190 m. The next candidates are 600, 500, none and 500 m away.
    """
    top = run(on_a_line(0, 100, 290, 600), [1000] * 4, k_min=1, delta=2)
    assert top.p_min_w[0] == pytest.approx(power_for(np.array([290, 190, 310, 310])))
    assert top.p_max_w[0] == pytest.approx(power_for(np.array([600, 500, 1000, 500])))
    assert np.argwhere(np.triu(top.adjacency[0])).tolist() == [[0, 1], [0, 2], [1, 2], [2, 3]]


def test_trimming_lowers_the_power_that_made_the_longest_spare_link():
    """With δ = 1 UAV 2 has one neighbour too many; 3 is its only link, so UAV 0 steps back."""
    top = run(on_a_line(0, 100, 290, 600), [1000] * 4, k_min=1, delta=1)
    assert np.argwhere(np.triu(top.adjacency[0])).tolist() == [[0, 1], [1, 2], [2, 3]]
    assert top.p_min_w[0] == pytest.approx(power_for(np.array([100, 190, 310, 310])))
    assert top.p_max_w[0, 0] == pytest.approx(power_for(290))
    assert np.array_equal(top.reach, top.adjacency)
    assert not top.over_degree.any()


def test_link_that_no_power_can_drop_leaves_the_lists_only():
    """UAVs 1 and 4 serve others 190 and 130 m away, so they, 120 m apart, hear each other."""
    top = run(on_a_line(0, 190, 200, 280, 310, 440), [1000] * 6, k_min=1, delta=1)
    links = np.argwhere(np.triu(top.adjacency[0])).tolist()
    assert links == [[0, 1], [1, 2], [2, 3], [3, 4], [4, 5]]
    assert np.argwhere(np.triu(top.reach[0] & ~top.adjacency[0])).tolist() == [[1, 4]]
    assert top.p_min_w[0, [1, 4]] == pytest.approx(power_for(np.array([190, 130])))


def test_global_repair_takes_the_shortest_missing_link():
    """Two pairs 400 m apart are joined by their nearest ends, which raise their powers to it."""
    top = run(on_a_line(0, 50, 450, 500), [1000] * 4, k_min=1, delta=2)
    assert np.argwhere(np.triu(top.adjacency[0])).tolist() == [[0, 1], [1, 2], [2, 3]]
    assert top.p_min_w[0] == pytest.approx(power_for(np.array([50, 400, 400, 50])))
    assert top.connected.all()


def test_weak_uav_lists_only_those_it_can_answer():
    """A UAV whose cap covers one neighbour has a deficit, takes that one, and stays below it."""
    top = run(on_a_line(0, 100, 180, 260), [110, 1000, 1000, 1000], k_min=2, delta=2)
    assert top.deficit[0].tolist() == [True, False, False, False]
    assert np.flatnonzero(top.adjacency[0, 0]).tolist() == [1]
    assert top.p_min_w[0, 0] <= power_for(110)
    assert top.p_upper_w[0, 0] == power_for(110)


def test_uavs_at_the_same_distance_are_taken_together():
    """Neighbours that no power can tell apart join together, so the interval is never empty."""
    square = np.array([[[0, 0, 0], [100, 0, 0], [0, 100, 0], [100, 100, 0]]], dtype=float)
    top = run(square, [1000] * 4, k_min=1, delta=3)
    assert top.adjacency[0].sum(axis=1).tolist() == [2, 2, 2, 2]
    assert (top.p_min_w < top.p_max_w).all()


def test_uavs_out_of_reach_are_flagged_not_raised():
    """Fleets that P_max cannot join end with a flag per slot and per UAV."""
    top = run(on_a_line(0, 5000), [1000, 1000], k_min=1)
    assert not top.connected[0]
    assert top.deficit.all()
    assert top.p_min_w.tolist() == [[0.0, 0.0]]
    assert np.array_equal(top.p_upper_w[0], power_for(np.array([1000, 1000])))


def test_one_uav_is_a_connected_network_without_links():
    """A fleet of one needs no power, and K_min must be 0."""
    top = run(on_a_line(0), [1000], k_min=0)
    assert top.connected.all()
    assert top.p_min_w.tolist() == [[0.0]]
    with pytest.raises(InputError, match="k_min is 1"):
        run(on_a_line(0), [1000], k_min=1)


def test_gains_give_the_same_topology_as_the_positions_behind_them():
    """Measured gains may take the place of positions."""
    rng = np.random.default_rng(5)
    positions, caps_w = rng.uniform(0, 1200, (4, 7, 3)), power_for(rng.uniform(800, 1200, 7))
    by_position = ctop(positions, CHANNEL, caps_w, SENSITIVITY_W, 2, 1)
    gain = CHANNEL.gain(pairwise_distances(positions))
    by_gain = ctop_of_gain(gain, caps_w, SENSITIVITY_W, 2, 1)
    assert np.array_equal(by_position.adjacency, by_gain.adjacency)
    assert by_position.p_max_w == pytest.approx(by_gain.p_max_w)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"positions_m": np.zeros((2, 3))}, "positions_m has shape"),
        ({"positions_m": np.full((1, 3, 3), np.nan)}, "not finite"),
        ({"p_max_w": np.ones(2)}, "p_max_w has shape"),
        ({"p_max_w": np.array([1.0, 0.0, 1.0])}, "must be positive watts"),
        ({"sensitivity_w": 0.0}, "sensitivity_w is 0.0"),
        ({"k_min": 3}, "k_min is 3, must be from 0 to 2"),
        ({"delta": -1}, "delta is -1"),
    ],
)
def test_senseless_arguments_are_refused(change, message):
    """What makes no sense is named, with what it should be."""
    arguments = {
        "positions_m": np.zeros((1, 3, 3)),
        "channel": CHANNEL,
        "p_max_w": np.ones(3),
        "sensitivity_w": SENSITIVITY_W,
        "k_min": 1,
        "delta": 1,
    }
    with pytest.raises(InputError, match=message):
        ctop(**(arguments | change))


@pytest.mark.parametrize(
    ("gain", "message"),
    [(np.ones((2, 3, 4)), "gain has shape"), (np.full((1, 3, 3), -1.0), "negative")],
)
def test_senseless_gains_are_refused(gain, message):
    """Gains must be square per slot and not negative."""
    with pytest.raises(InputError, match=message):
        ctop_of_gain(gain, np.ones(3), SENSITIVITY_W, 1, 1)
