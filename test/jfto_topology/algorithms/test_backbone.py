"""Connected dominating sets."""

import networkx as nx
import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from jfto_topology.algorithms.backbone import backbones


@settings(max_examples=100, deadline=None, derandomize=True)
@given(st.integers(0, 2**32 - 1), st.integers(1, 14), st.sampled_from([0.1, 0.3, 0.7]))
def test_backbone_dominates_and_connects_each_component_without_spare_members(seed, uavs, density):
    """In every component members are joined, cover all others, and none can be left out."""
    rng = np.random.default_rng(seed)
    links = np.triu(rng.random((1, uavs, uavs)) < density, 1)
    links |= links.transpose(0, 2, 1)
    members = set(np.flatnonzero(backbones(links)[0]).tolist())
    graph = nx.from_numpy_array(links[0])

    def holds(chosen, component):
        inside = graph.subgraph(chosen & component)
        return (
            len(inside) > 0
            and nx.is_connected(inside)
            and nx.is_dominating_set(graph.subgraph(component), set(inside))
        )

    for component in nx.connected_components(graph):
        assert holds(members, component)
        assert not any(holds(members - {a}, component) for a in members & component)


def test_hub_of_a_star_is_the_backbone():
    """The UAV that hears all others suffices."""
    links = np.zeros((1, 5, 5), dtype=bool)
    links[0, 3, [0, 1, 2, 4]] = links[0, [0, 1, 2, 4], 3] = True
    assert np.flatnonzero(backbones(links)[0]).tolist() == [3]
