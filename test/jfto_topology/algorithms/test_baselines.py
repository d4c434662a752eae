"""MTP, A-LMST, CPAPO: the rules of docs/explanation/baselines.md, and when energy ends."""

import networkx as nx
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from jfto_msgs_py.errors import InputError
from jfto_topology.algorithms.backbone import backbones
from jfto_topology.algorithms.cpapo import cpapo
from jfto_topology.algorithms.intervals import kept_intervals
from jfto_topology.algorithms.lmst import a_lmst
from jfto_topology.algorithms.mtp import mtp
from jfto_world.radio import LogDistanceChannel, mutual_links, pairwise_distances

CHANNEL = LogDistanceChannel(1e-4)
SENSITIVITY_W = 1e-10
PLENTY_J = 1e6


def power_for(distance_m):
    return CHANNEL.required_power(np.asarray(distance_m), SENSITIVITY_W)


def on_a_line(*x_m, slots=1):
    return np.array([[[x, 0.0, 0.0] for x in x_m]] * slots)


def fleet(seed, uavs=9, slots=4, spread=1500.0):
    rng = np.random.default_rng(seed)
    positions = rng.uniform(0, spread, (slots, uavs, 3)) * [1, 1, 0.1]
    return positions, power_for(rng.uniform(700, 1300, uavs))


def run(algorithm, positions, caps_w, energy_j=PLENTY_J, slot_s=1.0, **more):
    energy = np.broadcast_to(energy_j, caps_w.shape)
    return algorithm(positions, CHANNEL, caps_w, SENSITIVITY_W, energy, slot_s, **more)


def possible_links(positions, caps_w):
    gain = CHANNEL.gain(pairwise_distances(positions))
    return mutual_links(gain, np.broadcast_to(caps_w, positions.shape[:2]), SENSITIVITY_W)


def components(adjacency):
    return [nx.number_connected_components(nx.from_numpy_array(slot)) for slot in adjacency]


def links(adjacency):
    return np.argwhere(np.triu(adjacency)).tolist()


def test_mtp_has_every_possible_link_until_energy_ends():
    """P_max in each slot that can be paid for in full, slot 0 being free, then silence for good."""
    positions = on_a_line(0, 300, 600, slots=5)
    caps_w = power_for([400, 400, 400])
    played = run(mtp, positions, caps_w, energy_j=caps_w[0] * np.array([9, 2.5, 9]))
    assert played.on_air[:, 1].tolist() == [True, True, True, False, False]
    assert np.array_equal(played.power_w, np.where(played.on_air, caps_w, 0))
    assert links(played.adjacency[2]) == [[0, 1], [1, 2]]
    assert not played.adjacency[3].any()


@settings(max_examples=60, deadline=None, derandomize=True)
@given(st.integers(0, 2**32 - 1), st.sampled_from([600.0, 1500.0, 2500.0]))
def test_baselines_keep_the_fleet_as_connected_as_full_power_does(seed, spread):
    """A-LMST and CPAPO have as many components as P_max, at powers that P_max covers."""
    positions, caps_w = fleet(seed, spread=spread)
    best = components(possible_links(positions, caps_w))
    for played in (
        run(a_lmst, positions, caps_w, speed_mps=np.full(9, 10.0)),
        run(cpapo, positions, caps_w),
    ):
        assert components(played.adjacency) == best
        assert components(played.listed) == best
        assert (played.power_w <= caps_w).all()
        assert not (played.listed & ~played.adjacency).any()
        gain = CHANNEL.gain(pairwise_distances(positions))
        heard = mutual_links(gain, played.power_w, SENSITIVITY_W)
        assert np.array_equal(played.adjacency, heard)


def slow_lmst(distance, possible):
    """LMST with G+ by networkx's Kruskal over each visible neighbourhood."""
    count = len(distance)
    kept = np.zeros((count, count), dtype=bool)
    for u in range(count):
        near = [u, *np.flatnonzero(possible[u])]
        graph = nx.Graph()
        graph.add_nodes_from(near)
        for a in near:
            for b in near:
                if a < b and possible[a, b]:
                    graph.add_edge(a, b, weight=distance[a, b])
        for v in nx.minimum_spanning_tree(graph)[u]:
            kept[u, v] = kept[v, u] = True
    return kept


@settings(max_examples=60, deadline=None, derandomize=True)
@given(st.integers(0, 2**32 - 1))
def test_a_lmst_keeps_the_links_of_local_minimum_spanning_trees(seed):
    """The listed links are those of another implementation of LMST with G+."""
    positions, caps_w = fleet(seed)
    played = run(a_lmst, positions, caps_w, speed_mps=np.zeros(9))
    possible, distance = possible_links(positions, caps_w), pairwise_distances(positions)
    for n in range(len(positions)):
        assert np.array_equal(played.listed[n], slow_lmst(distance[n], possible[n]))


def test_a_lmst_breaks_ties_so_that_a_square_stays_connected():
    """On a unit square all sides are equal; one order for all UAVs drops exactly one of them."""
    square = np.array([[[0, 0, 0], [100, 0, 0], [0, 100, 0], [100, 100, 0]]], dtype=float)
    played = run(a_lmst, square, power_for([1000] * 4), speed_mps=np.zeros(4))
    assert links(played.listed[0]) == [[0, 1], [0, 2], [1, 3]]


def test_a_lmst_adds_what_both_ends_may_move_in_a_slot():
    """Power covers the farthest kept neighbour plus (v_a + v_b) Δt, clamped to P_max."""
    played = run(
        a_lmst,
        on_a_line(0, 100, 300),
        power_for([1000, 1000, 220]),
        slot_s=2.0,
        speed_mps=np.array([5, 10, 15]),
    )
    assert played.power_w[0] == pytest.approx(power_for([130, 250, 220]))


def test_cpapo_around_a_hub_is_a_star_plus_what_its_powers_reach():
    """One UAV sees all: it alone is the backbone, and each other one keeps its link to it."""
    positions = np.array([[[0, 0, 0], [500, 0, 0], [-500, 10, 0], [0, 510, 0], [0, -520, 0]]])
    played = run(cpapo, positions.astype(float), power_for([600] * 5))
    assert links(played.listed[0]) == [[0, 1], [0, 2], [0, 3], [0, 4]]
    assert played.power_w[0, 1] == pytest.approx(power_for(500))
    assert played.power_w[0, 0] == pytest.approx(power_for(520))


def test_cpapo_on_a_line_keeps_the_inner_uavs_as_backbone():
    """On a line nothing can be pruned but the ends, which are leaves."""
    played = run(cpapo, on_a_line(0, 300, 600, 900, 1200), power_for([400] * 5))
    assert links(played.listed[0]) == [[0, 1], [1, 2], [2, 3], [3, 4]]


@settings(max_examples=40, deadline=None, derandomize=True)
@given(st.integers(0, 2**32 - 1))
def test_cpapo_ends_where_no_uav_can_lower_its_power_further(seed):
    """Dropping any UAV's farthest link splits the backbone or leaves a UAV without one."""
    positions, caps_w = fleet(seed, uavs=7, slots=2, spread=900.0)
    played = run(cpapo, positions, caps_w)
    members, distance = backbones(possible_links(positions, caps_w)), pairwise_distances(positions)
    for n in range(2):
        inner = set(np.flatnonzero(members[n]).tolist())
        graph = nx.from_numpy_array(played.listed[n])

        def served(graph, inner=inner):
            leaves_held = all(set(graph[a]) & inner for a in graph if a not in inner)
            return leaves_held and nx.number_connected_components(graph.subgraph(inner))

        before = served(graph)
        assert before
        for a in graph:
            far = max(graph[a], key=lambda b, a=a, n=n: distance[n, a, b])
            less = graph.copy()
            less.remove_edge(a, far)
            assert served(less) != before


def test_energy_ends_for_reconstructed_baselines_too():
    """A UAV that overruns its budget goes off the air whatever the algorithm."""
    positions = on_a_line(0, 300, 600, slots=4)
    caps_w = power_for([400] * 3)
    energy = power_for(300) * np.array([9, 1.5, 9])
    lmst = run(a_lmst, positions, caps_w, energy_j=energy, speed_mps=np.zeros(3))
    pruned = run(cpapo, positions, caps_w, energy_j=energy)
    for played in (lmst, pruned):
        assert played.on_air[:, 1].tolist() == [True, True, False, False]
        assert not played.adjacency[2:].any()


def test_isolated_uav_is_silent_but_not_depleted():
    """Nobody in reach means no power, which is not the same as no energy."""
    positions = on_a_line(0, 100, 5000)
    played = run(cpapo, positions, power_for([1000] * 3))
    assert played.power_w[0, 2] == 0
    assert played.on_air.all()


@settings(max_examples=30, deadline=None, derandomize=True)
@given(st.integers(0, 2**32 - 1))
def test_kept_intervals_hold_a_baseline_topology(seed):
    """Any powers inside the intervals make at least the links asked for, and the same ones."""
    positions, caps_w = fleet(seed)
    played = run(cpapo, positions, caps_w)
    low, upper = kept_intervals(played.listed, positions, CHANNEL, caps_w, SENSITIVITY_W)
    gain = CHANNEL.gain(pairwise_distances(positions))
    at_low = mutual_links(gain, low, SENSITIVITY_W)
    assert not (played.listed & ~at_low).any()
    rng = np.random.default_rng(seed)
    drawn = low + rng.uniform(0, 1, low.shape) * (upper - low)
    assert np.array_equal(mutual_links(gain, drawn, SENSITIVITY_W), at_low)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"energy_j": np.ones(2)}, "energy_j is"),
        ({"energy_j": np.array([1.0, -1.0, 1.0])}, "energy_j is"),
        ({"slot_duration_s": 0.0}, "slot_duration_s is 0.0"),
        ({"speed_mps": np.array([1.0, np.inf, 1.0])}, "speed_mps is"),
        ({"speed_mps": np.ones(4)}, "speed_mps is"),
    ],
)
def test_senseless_arguments_are_refused(change, message):
    """Budgets, slots and speeds that make no sense are named."""
    arguments = {
        "positions_m": on_a_line(0, 100, 200),
        "channel": CHANNEL,
        "p_max_w": np.ones(3),
        "sensitivity_w": SENSITIVITY_W,
        "energy_j": np.ones(3),
        "slot_duration_s": 1.0,
        "speed_mps": np.ones(3),
    }
    with pytest.raises(InputError, match=message):
        a_lmst(**(arguments | change))


def test_one_energy_serves_all():
    """A single budget is that of every UAV."""
    positions, caps_w = on_a_line(0.0, 500.0, 1000.0, slots=2), power_for(np.full(3, 700.0))
    half_j = caps_w[0] / 2
    one = mtp(positions, CHANNEL, caps_w, SENSITIVITY_W, half_j, 1.0)
    each = mtp(positions, CHANNEL, caps_w, SENSITIVITY_W, np.full(3, half_j), 1.0)
    assert np.array_equal(one.power_w, each.power_w)
    assert one.power_w.tolist() == [caps_w.tolist(), [0.0, 0.0, 0.0]]
