"""Rate to the ground against hand-computed networks, and against maximum flow where both agree."""

import networkx as nx
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from jfto_msgs_py.errors import InputError
from jfto_topology.ground_rate import ONE_BAND, deaf_uavs, ground_rate


def network(nodes, links):
    """Rates (1, nodes, nodes) of links given as (a, b, rate), the same in both directions."""
    rate = np.zeros((1, nodes, nodes))
    for a, b, value in links:
        rate[0, a, b] = rate[0, b, a] = value
    return rate


def test_a_chain_by_hand():
    """Three UAVs in a row over links of 12: the last relay sends 3 r and receives 2 r.

    Its time is 5 r / 12, so r is 2.4; in one band the three links take 6 r / 12.
    """
    chain = network(4, [(0, 1, 12.0), (1, 2, 12.0), (2, 3, 12.0)])
    assert ground_rate(chain, 1) == pytest.approx([2.4])
    assert ground_rate(chain, 1, ONE_BAND) == pytest.approx([2.0])


def test_a_star_shares_the_stations_time():
    """Three UAVs beside the station over links of 12, 6 and 4: r (1/12 + 1/6 + 1/4) = 1."""
    star = network(4, [(0, 3, 12.0), (1, 3, 6.0), (2, 3, 4.0)])
    assert ground_rate(star, 1) == pytest.approx([2.0])
    # With a second station beside the slowest, the first has room; the slowest sends by itself.
    rate = np.zeros((1, 5, 5))
    rate[:, :4, :4] = star
    rate[0, 2, 4] = rate[0, 4, 2] = 4.0
    assert ground_rate(rate, 2) == pytest.approx([4.0])


def test_one_who_is_cut_off_makes_it_zero():
    """Nobody's rate counts while one cannot send; who that is, is told."""
    rate = network(4, [(0, 1, 5.0), (2, 3, 5.0)])
    assert ground_rate(rate, 1).tolist() == [0.0]
    assert deaf_uavs(rate > 0, 1).tolist() == [[True, True, False]]


def fits(linked, rate):
    """Whether every UAV can send `rate` over links of rate 1, by networkx's maximum flow.

    A relay receives x and sends x + rate, so x is at most (1 - rate) / 2; the station's time is 1.
    """
    uavs = len(linked) - 1
    graph = nx.DiGraph()
    for a in range(uavs):
        graph.add_edge("source", ("out", a), capacity=rate)
        graph.add_edge(("in", a), ("out", a), capacity=max((1 - rate) / 2, 0))
        for b in range(uavs):
            if linked[a, b]:
                graph.add_edge(("out", a), ("in", b))
        if linked[a, uavs]:
            graph.add_edge(("out", a), "station")
    graph.add_edge("station", "sink", capacity=1.0)
    return nx.maximum_flow_value(graph, "source", "sink") >= uavs * rate * (1 - 1e-9)


@settings(max_examples=40, deadline=None, derandomize=True)
@given(st.integers(1, 7), st.integers(0, 2**32 - 1))
def test_it_is_the_greatest_that_a_maximum_flow_carries(uavs, seed):
    """Over links of one rate: what is found fits as a flow, a thousandth more does not."""
    rng = np.random.default_rng(seed)
    linked = np.triu(rng.uniform(size=(uavs + 1, uavs + 1)) < 0.5, 1)
    linked |= linked.T
    found = float(ground_rate(linked[None].astype(float), 1)[0])
    if deaf_uavs(linked[None], 1).any():
        assert found == 0
        return
    assert fits(linked, found * (1 - 1e-6))
    assert not fits(linked, found * 1.001)


@settings(max_examples=60, deadline=None, derandomize=True)
@given(st.integers(1, 8), st.integers(1, 2), st.integers(0, 2**32 - 1))
def test_more_rate_never_hurts_and_one_band_never_helps(uavs, stations, seed):
    """The rate grows with every link's, scales with all of them, and is least in one band."""
    rng = np.random.default_rng(seed)
    nodes = uavs + stations
    rate = rng.uniform(1, 10, (1, nodes, nodes)) * (rng.uniform(size=(1, nodes, nodes)) < 0.6)
    rate = np.triu(rate[0], 1)[None]
    rate = rate + rate.transpose(0, 2, 1)
    own, band = ground_rate(rate, stations), ground_rate(rate, stations, ONE_BAND)
    assert (band <= own * (1 + 1e-6) + 1e-9).all()
    assert ground_rate(rate * 3, stations) == pytest.approx(3 * own, rel=1e-6)
    assert (ground_rate(rate + (rate > 0), stations) >= own * (1 - 1e-6)).all()
    assert ((own > 0) == ~deaf_uavs(rate > 0, stations).any(axis=1)).all()


@pytest.mark.parametrize(
    ("rate", "stations", "mac", "said"),
    [
        (np.ones((2, 2)), 1, "one_band", "shape"),
        (np.ones((1, 2, 2)), 0, "one_band", "stations is 0"),
        (np.ones((1, 2, 2)), 2, "one_band", "stations is 2"),
        (-np.ones((1, 2, 2)), 1, "one_band", "negative"),
        (np.ones((1, 2, 2)), 1, "csma", "node_exclusive"),
    ],
)
def test_senseless_arguments_are_refused(rate, stations, mac, said):
    """Each is named with its value."""
    with pytest.raises(InputError, match=said):
        ground_rate(rate, stations, mac)
