"""The ground as a marker."""

from __future__ import annotations

import numpy as np
import pytest
from visualization_msgs.msg import Marker, MarkerArray

from jfto_msgs_py.ros import qos, topics
from jfto_topology.node.terrain_mesh import CELLS_MAX, terrain_triangles
from jfto_topology.node.topology_node import TopologyNode
from jfto_world.terrain import Dem, load_dem
from support.graph import Graph


@pytest.fixture(scope="module")
def dem() -> Dem:
    """The built-in tile around the demonstration."""
    return load_dem("jacksboro", center=(36.6255, -84.2650), size_m=(500.0, 400.0))


def test_triangles_cover_the_area_and_lie_on_the_ground(dem) -> None:
    """Both triangles of a cell face up; corners are heights of the model."""
    triangles, colors = terrain_triangles(dem, 50.0)
    assert triangles.shape == (2 * 10 * 8, 3, 3)
    assert colors.shape == (160, 3)
    flat = triangles[:, :, :2]
    edges = flat[:, 1:] - flat[:, :1]
    area = 0.5 * (edges[:, 0, 0] * edges[:, 1, 1] - edges[:, 0, 1] * edges[:, 1, 0])
    assert (area > 0).all()
    assert area.sum() == pytest.approx(500.0 * 400.0)
    corners = triangles.reshape(-1, 3)
    assert np.allclose(corners[:, 2], dem.height(corners[:, 0], corners[:, 1]))
    assert (colors > 0).all()
    assert (colors <= 1).all()


def test_cells_do_not_flood_the_network(dem) -> None:
    """A millimetre is asked for, 10 000 cells are what there is."""
    triangles, _ = terrain_triangles(dem, 0.001)
    assert CELLS_MAX <= len(triangles) / 2 <= 1.03 * CELLS_MAX


def test_a_late_joiner_sees_the_ground_where_it_is_asked_for(dem) -> None:
    """Once, latched, in frame map; without the parameter there is no such topic."""
    with Graph() as graph:
        node = graph.add(TopologyNode, lambda scenario: dem, terrain_cell_m=100.0)
        got = graph.collect(MarkerArray, topics.TERRAIN, qos.latched())
        graph.until(lambda: got)
        graph.remove(node)
        graph.add(TopologyNode, lambda scenario: dem)
        assert graph.observer.count_publishers(topics.TERRAIN) == 0
    mesh = got[0].markers[0]
    assert (mesh.type, mesh.header.frame_id) == (Marker.TRIANGLE_LIST, "map")
    assert len(mesh.points) == len(mesh.colors) == 3 * 2 * 5 * 4
